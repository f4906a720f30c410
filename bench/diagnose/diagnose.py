"""From a campaign to a naming: replay, screen, refit. Extension files are written by `bench.report.diagnosis`."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from bench.diagnose.ask.ask import ask
from bench.diagnose.ask.blind_spots import blind_spots
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.measure.measure import HeldOut, held_out, predicted_error
from bench.diagnose.name.learn import Lesson, lesson_of
from bench.diagnose.name.naming import Naming, name_cause
from bench.diagnose.name.surroundings import Surroundings
from bench.diagnose.picture.candidates import causes_of, unseen_of
from bench.diagnose.picture.design import Design, design_of
from bench.diagnose.picture.signatures import Signatures
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import MOST_BINS, segments_of
from bench.diagnose.verdict import Proposal, Verdict, verdict_of
from bench.effects.effect import Effect
from bench.errors import BenchError, InputError
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store

FALSE_ALARM_RATE = 0.01


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict with all that it rests on."""

    design: Design
    naming: Naming
    verdict: Verdict
    lesson: Lesson | None = None

    @property
    def extension(self) -> Fit | None:
        """The model with what was found, listed or learned; None where there is nothing to add."""
        return extension_of(self.naming, self.lesson)


def extension_of(naming: Naming, lesson: Lesson | None) -> Fit | None:
    """Return the model with what was found, listed or learned; None where there is nothing to add."""
    if lesson and lesson.pays:
        return lesson.fit
    return naming.hypotheses[0].fit if naming.hypotheses else None


def diagnose(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
    signatures: Signatures | None = None,
    most_bins: int = MOST_BINS,
    asks: bool = True,
    store: Store | None = None,
) -> Diagnosis:
    """Say what the nominal model gets wrong about a campaign.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
        catalogue: Effects to look for.
        rate: Share of null campaigns in which anything at all may be found.
        progress: Called with what is done next.
        signatures: Of other campaigns of the same session, if there were any; from `signatures_of`.
        most_bins: How many bins all motion together may have.
        asks: Whether to look for the next experiment, and for what the campaign could not show.
        store: Where signatures are kept between processes; None: nowhere. Not used with `signatures`.

    Raises:
        InputError: The campaign has nothing that a replay predicts.
        ConvergenceError: The nominal model finds no balance along the measured motion.
        ValueError: Signatures of another kind of session.
    """
    with threadpool_limits(1, "blas"):  # the matrices are small: threads take more than twice the time
        return _diagnose(campaign, compiled, catalogue, rate, progress, signatures, most_bins, asks, store)


def _diagnose(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    rate: float,
    progress: Callable[[str], None],
    signatures: Signatures | None,
    most_bins: int,
    asks: bool,
    store: Store | None,
) -> Diagnosis:
    own = signatures_of(campaign, compiled, catalogue, store)
    signatures = own if signatures is None else signatures
    if signatures.asked != own.asked:
        raise ValueError("these signatures are of other channels or other causes than this campaign and catalogue have")
    quantities = signatures.quantities
    segments = segments_of(campaign, compiled, quantities, most_bins)
    if not segments or not quantities:
        raise InputError(
            "the campaign has no channel that a replay predicts: log motor currents or torques, a reflector, a link "
            "encoder, or the gas pressure, beside the motor angles."
        )
    progress(f"signatures of {len(signatures.causes)} causes")
    changes = signatures.changes(segments)
    design = design_of(Replay(compiled, segments, quantities), signatures.nuisances, changes.nuisances)
    progress("naming")
    around = Surroundings(compiled, catalogue, measured_by(campaign), rate)
    design, screening = around.weighed(design, signatures.causes, changes)
    naming = name_cause(design, screening, around.about, progress)
    worth: HeldOut | None = None
    proposals: tuple[Proposal, ...] = ()
    if naming.unlisted:
        progress("learning what is not listed")
    lesson = lesson_of(naming)
    extension = extension_of(naming, lesson)
    about = lesson.design if lesson and lesson.pays else naming.design
    if extension:
        progress("gain on what was held out")
        null = naming.null if about is naming.design else refit(about, (), {})
        worth = held_out(about, null, extension)
    if naming.hypotheses and asks:
        progress("the next experiment")
        with suppress(BenchError):  # an explanation that finds no balance elsewhere proposes nothing
            proposals = ask(naming.design, [hypothesis.fit for hypothesis in naming.alternatives])
    predicted = predicted_error(about, extension or naming.null) if asks else ()
    blind = blind_spots(compiled, segments, quantities, screening, signatures.causes) if asks else ()
    missing = unseen_of(catalogue.values(), around.measured)
    verdict = verdict_of(naming, rate, missing, signatures.unbalanced, worth, proposals, lesson)
    return Diagnosis(about, naming, replace(verdict, blind=blind, predicted=predicted), lesson)


def signatures_of(
    campaign: Campaign, compiled: CompiledRobot, catalogue: Mapping[str, Effect], store: Store | None = None
) -> Signatures:
    """Return the signatures of a campaign and of all others of its session; nothing is simulated yet."""
    quantities = quantities_of(campaign.runs, compiled)
    causes = causes_of(catalogue.values(), compiled, measured_by(campaign))
    return Signatures(compiled, quantities, nuisances_of(compiled, quantities), causes, store=store)


def measured_by(campaign: Campaign) -> frozenset[str]:
    """Return the quantities of a campaign, without numbers and units."""
    names = {name for run in campaign.runs for name in run.columns}
    words = (name.split("_")[:-1] for name in names)
    return frozenset("_".join(word for word in part if not word.isdigit()) for part in words)
