"""From a campaign to a naming: replay, screen, refit. Extension files are written by `bench.report.diagnosis`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bench.diagnose.candidates import candidates_of, causes_of, changes_of, plan_of, unseen_of
from bench.diagnose.design import Design, design_of
from bench.diagnose.generic import blocks_of
from bench.diagnose.naming import Naming, name_cause
from bench.diagnose.nuisances import nuisances_of
from bench.diagnose.quantities import quantities_of
from bench.diagnose.replay import Replay
from bench.diagnose.screening import screen
from bench.diagnose.segments import segments_of
from bench.diagnose.verdict import Verdict, verdict_of
from bench.effects.effect import Effect
from bench.errors import InputError
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot

FALSE_ALARM_RATE = 0.01


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict with all that it rests on."""

    design: Design
    naming: Naming
    verdict: Verdict


def diagnose(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
) -> Diagnosis:
    """Say what the nominal model gets wrong about a campaign.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
        catalogue: Effects to look for.
        rate: Share of null campaigns in which anything at all may be found.
        progress: Called with what is done next.

    Raises:
        InputError: The campaign has nothing that a replay predicts.
        ConvergenceError: The nominal model finds no balance along the measured motion.
    """
    quantities = quantities_of(campaign.runs, compiled)
    segments = segments_of(campaign, compiled, quantities)
    if not segments or not quantities:
        raise InputError(
            "the campaign has no channel that a replay predicts: log motor currents or torques, a reflector, a link "
            "encoder, or the gas pressure, beside the motor angles."
        )
    progress("replay of the nominal model")
    design = design_of(Replay(compiled, segments, quantities), nuisances_of(compiled, quantities))
    measured = _measured(campaign)
    causes = causes_of(catalogue.values(), compiled, measured)
    progress(f"signatures of {len(causes)} causes")
    candidates = candidates_of(design, causes, changes=changes_of(design, plan_of(causes)))
    if not candidates:
        raise InputError("no effect of the catalogue would leave a trace in this campaign; see bench effects.")
    progress("naming")
    screening = screen(design, candidates, blocks_of(design), rate, np.random.default_rng(0))
    naming = name_cause(design, screening, progress)
    return Diagnosis(design, naming, verdict_of(naming, rate, unseen_of(catalogue.values(), measured)))


def _measured(campaign: Campaign) -> frozenset[str]:
    """Return the quantities of a campaign, without numbers and units."""
    names = {name for run in campaign.runs for name in run.columns}
    words = (name.split("_")[:-1] for name in names)
    return frozenset("_".join(word for word in part if not word.isdigit()) for part in words)
