"""The line on the virtual robot: sessions side by side, each with what was read and, apart from it, what was true."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.executor.contract import Executor, Progress, in_order
from bench.identify.compensation import Compensation
from bench.identify.line_passes import AXES, STATES, WAYS, LinePasses, line_passes
from bench.record.campaign import Run
from bench.report.campaigns import open_usable
from bench.report.results import CAMPAIGN, run_and_write
from bench.robot.bodies import Array
from bench.scenario.line import Line


@dataclass(frozen=True)
class TruePass:
    """One pass as ideal instruments would have read it, T places from the start of the line to its end (truth).

    Attributes:
        q_motor: Shape (T, n) [rad].
        q_link: Shape (T, n) [rad].
        reflector: Shape (T, 3) [m], the reference point.
    """

    q_motor: Array
    q_link: Array
    reflector: Array


@dataclass(frozen=True)
class LineSession:
    """One session on the line.

    Attributes:
        passes: What was measured, read back from the checked campaign.
        truth: (state, way) -> the same without instruments.
        stiffness: Shape (n,) [Nm/rad], as simulated (truth).
    """

    passes: LinePasses
    truth: Mapping[tuple[str, str], TruePass]
    stiffness: Array


def run_line_sessions(jobs: Sequence[tuple[Line, Path]], progress: Progress, executor: Executor) -> list[LineSession]:
    """Run scenarios, each into a folder of its own: campaign, truth, recording.

    Args:
        jobs: Scenarios with their folders, which must not exist.
        progress: Called with the share that is done.
        executor: Where to simulate.

    Raises:
        InputError: A scenario does not fit its robot.
        CampaignError: A campaign does not pass its own check.
    """
    return in_order(executor, run_line_session, jobs, progress)


def run_line_session(job: tuple[Line, Path], progress: Progress) -> LineSession:
    """Run one scenario into its folder; arguments and errors as in `run_line_sessions`."""
    _, folder = job
    session = run_and_write(job, progress)
    campaign, _ = open_usable(folder / CAMPAIGN)
    return LineSession(
        passes=line_passes(campaign, session.compiled.robot.figures),
        truth={key: _true_pass(run, session.compiled.n_joints) for run in session.ideal for key in _keys(run)},
        stiffness=session.compiled.stiffness,
    )


def compensated(scenario: Line, compensation: Compensation) -> Line:
    """Return the scenario with the corrections of a method, under load only."""
    corrections = {
        "share": compensation.share.tolist(),
        **{f"{way}_rad": compensation.ways[way].knots.tolist() for way in WAYS},
    }
    return Line.model_validate(scenario.model_dump() | {"unloaded": False, "corrections": corrections})


def _keys(run: Run) -> list[tuple[str, str]]:
    return [(state, way) for state in STATES for way in WAYS if run.name == f"{state}-{way}"]


def _true_pass(run: Run, n: int) -> TruePass:
    drives = tuple(str(j) for j in range(1, n + 1))
    order = -1 if run.name.endswith("back") else 1
    return TruePass(
        q_motor=np.array(run.stack("q_motor", "rad", drives)[::order]),
        q_link=np.array(run.stack("q_link", "rad", drives)[::order]),
        reflector=np.array(run.stack("reflector", "m", tuple(f"1_{axis}" for axis in AXES))[::order]),
    )
