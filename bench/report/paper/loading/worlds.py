"""The loading experiment on the virtual robot in each friction world, identified by every method, beside the truth."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.executor.contract import Executor, Progress, in_order
from bench.identify.estimate import StiffnessEstimate
from bench.report.campaigns import open_usable
from bench.report.identification import identify_campaign
from bench.report.paper.methods.protocols import in_words
from bench.report.results import CAMPAIGN, TRUTH, run_and_forget
from bench.report.scoring import Score, score_stiffness
from bench.scenario.files import read_as
from bench.scenario.loading import Loading


@dataclass(frozen=True)
class World:
    """Where static friction sits, and what the servo does about it.

    Attributes:
        name: Folder name.
        title: What people read.
        friction, servo: Keys of the scenario.
    """

    name: str
    title: str
    friction: str
    servo: str


WORLDS = (
    World("link-side", "friction on the link side", "link", "integral"),
    World("motor-side", "friction on the motor side, servo gives", "motor", "proportional"),
    World("motor-side-held", "friction on the motor side, servo holds", "motor", "integral"),
    World("both-sides", "friction on both sides, as in the MJCF, servo holds", "as-model", "integral"),
)


@dataclass(frozen=True)
class WorldResult:
    """What the methods found in one world.

    Attributes:
        world: Which.
        estimates: Method -> estimate.
        scores: Method -> one score per joint.
        protocol: How the experiment was done, in words.
    """

    world: World
    estimates: dict[str, StiffnessEstimate]
    scores: dict[str, tuple[Score, ...]]
    protocol: str

    def median_error(self, method: str) -> float:
        """Return the median over the observable joints of the absolute relative error."""
        return float(np.nanmedian([abs(score.error) for score in self.scores[method]]))

    def covered(self, method: str) -> tuple[int, int]:
        """Return how many intervals contain the truth, and of how many."""
        known = [score.covered for score in self.scores[method] if score.covered is not None]
        return sum(known), len(known)


def run_worlds(scenario: str, folder: Path, progress: Progress, executor: Executor) -> list[WorldResult]:
    """Run the scenario in every world, each into a folder of its own, and identify.

    Args:
        scenario: Name or file of a loading scenario; its friction and servo are overridden.
        folder: Existing folder; one folder per world is written into it.
        progress: Called with the share that is done.
        executor: Where to simulate.

    Raises:
        InputError: The scenario is not valid or does not fit its robot.
    """
    base = read_as(Loading, scenario)
    changes = [{"friction": world.friction, "servo": world.servo} for world in WORLDS]
    scenarios = [Loading.model_validate(base.model_dump() | change) for change in changes]
    jobs = [(job, folder / world.name) for job, world in zip(scenarios, WORLDS, strict=True)]
    in_order(executor, run_and_forget, jobs, progress)
    return [_identified(world, folder / world.name, in_words(base)) for world in WORLDS]


def _identified(world: World, folder: Path, protocol: str) -> WorldResult:
    campaign, compiled = open_usable(folder / CAMPAIGN)
    estimates = dict(identify_campaign(folder / CAMPAIGN, campaign, compiled).estimates)
    scores = {name: score_stiffness(estimate, folder / TRUTH) for name, estimate in estimates.items()}
    return WorldResult(world, estimates, scores, protocol)
