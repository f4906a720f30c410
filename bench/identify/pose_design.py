"""Which poses to measure next: those that together are D-optimal for the joint compliances."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bench.identify.d_optimal import choose
from bench.identify.pose_candidates import Rules, around, sample
from bench.identify.pose_plan import PLANNED, Load, Setup, Visits, information
from bench.identify.pose_precision import Precision, expected_precision, prior_information
from bench.robot.bodies import Array

N_CANDIDATES = 1000  # of each kind of load; four times as many gain at most 3 % in D-efficiency
NEAR = np.deg2rad([10.0, 5.0, 2.0])  # [rad], spread of the rounds of search around the chosen poses; they gain 10 %
STARTS = 4  # random starts of the exchange beside the greedy one
N_NEAR = 80  # candidates around each chosen pose in each round


@dataclass(frozen=True)
class PoseDesign:
    """Chosen visits and what they will tell.

    Attributes:
        method: Method of identification they were chosen for.
        visits: The new poses, each with its load; poses may lie close together, where that says most.
        precision: What to expect of them, together with what was measured before.
    """

    method: str
    visits: Visits
    precision: Precision

    @property
    def q_deg(self) -> Array:
        """Shape (v, n) [deg]."""
        return np.rad2deg(self.visits.q)


def design_poses(
    setup: Setup,
    method: str,
    rules: Rules,
    hanging: Load,
    slanting: Sequence[Load],
    count: int,
    max_slanting: int,
    rng: np.random.Generator,
    measured: Visits | None = None,
    phase: Callable[[str], None] = lambda words: None,
) -> PoseDesign:
    """Choose the poses and loads that, with what was measured before, tell most about all compliances.

    Candidates are drawn evenly over the joint ranges, then near the best; the same generator gives the same design.

    Args:
        setup: What is the same at every pose.
        method: A key of `PLANNED`.
        rules: Which poses may be measured at.
        hanging: The load that may hang at any pose.
        slanting: Loads that pull at an angle; one of them may pull at up to `max_slanting` poses.
        count: Number of poses.
        max_slanting: See `slanting`.
        rng: Source of the candidates.
        measured: Visits that were already made, if any.
        phase: Is told what begins; hundreds of poses take minutes.

    Raises:
        InputError: Not enough poses keep the rules.
    """
    known = prior_information(setup, PLANNED[method])
    if measured is not None:
        known += information(setup, measured, PLANNED[method]).sum(axis=0)

    def best(visits: Visits, starts: int) -> Visits:
        slants = np.array([not load.hangs(setup.arm.bodies.gravity) for load in visits.loads])
        candidates = information(setup, visits, PLANNED[method])
        return visits.take(choose(candidates, known, setup.arm.n_joints, count, slants, max_slanting, rng, starts))

    phase("drawing poses")
    visits = sample(setup, [hanging], rules, N_CANDIDATES, rng)
    if slanting and max_slanting:
        visits += sample(setup, slanting, rules, N_CANDIDATES, rng)
    phase(f"choosing {count} of {len(visits.loads)}")
    visits = best(visits, STARTS)
    for k, spread in enumerate(NEAR, start=1):
        phase(f"looking for better ones near each, {k} of {len(NEAR)}")
        visits += around(setup, visits, rules, spread, N_NEAR, rng)
        visits = best(visits, 0)
    together = visits if measured is None else measured + visits
    return PoseDesign(method, visits, expected_precision(setup, together, method))
