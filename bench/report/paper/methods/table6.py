"""What Table 6, force over current, says about friction: how much of it on which side gives the published ratios."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.report.paper.methods.study import ConditionResult
from bench.robot.bodies import Array


@dataclass(frozen=True)
class NeededFriction:
    """Friction that gives the paper's ratios under one protocol; n joints.

    Attributes:
        level: Shape (n,), on the link side alone, relative to the robot's figures; nan where none up to `most` does.
        by_motor: Shape (n,) bool, whether friction on the motor side alone, up to `most`, gives it.
        most: The most friction that was tried.
    """

    level: Array
    by_motor: Array
    most: float

    @property
    def by_link(self) -> int:
        """In how many joints friction on the link side alone can give the ratio."""
        return int(np.isfinite(self.level).sum())


def needed_friction(results: Sequence[ConditionResult], published: Array, force: str, current: str) -> NeededFriction:
    """Return which friction gives the published ratios.

    Args:
        results: Over amounts of friction all on the link side, and all on the motor side, of one protocol.
        published: Shape (n,), force over current.
        force: Name of the analysis by forces.
        current: Name of the one by currents.
    """
    amounts, link = _ratios(results, 1.0, force, current)
    _, motor = _ratios(results, 0.0, force, current)
    level = np.full(len(published), np.nan)
    for j, wanted in enumerate(published):
        known = np.isfinite(link[:, j])
        rising = np.maximum.accumulate(link[known, j])
        if rising.size and rising[0] <= wanted <= rising[-1]:
            level[j] = np.interp(wanted, rising, amounts[known])
    lowest = np.where(np.isfinite(motor), motor, np.inf).min(axis=0)
    highest = np.where(np.isfinite(motor), motor, -np.inf).max(axis=0)
    inside = (lowest <= published) & (published <= highest)
    return NeededFriction(level, inside, float(amounts[-1]))


def _ratios(results: Sequence[ConditionResult], share: float, force: str, current: str) -> tuple[Array, Array]:
    line = sorted((r for r in results if r.condition.link_share == share), key=lambda r: r.condition.friction)
    return np.array([r.condition.friction for r in line]), np.stack([r.ratio(force, current) for r in line])
