"""Estimate against truth. The only module that opens the truth."""

from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from bench.errors import InputError
from bench.identify.counterbalance_fit import CounterbalanceFit
from bench.identify.estimate import StiffnessEstimate
from bench.record.truth import TrueValue, read_truth
from bench.report.jsonable import to_jsonable


@dataclass(frozen=True)
class Score:
    """One estimated parameter beside the truth.

    Attributes:
        name: Of the joint for a stiffness; else of the parameter, as in the truth.
        unit: Of all numbers.
        truth: As simulated.
        estimate: As identified; nan where the data cannot tell.
        low, high: Ends of the interval.
    """

    name: str
    unit: str
    truth: float
    estimate: float
    low: float
    high: float

    @property
    def error(self) -> float:
        """Relative, estimate / truth - 1."""
        return self.estimate / self.truth - 1

    @property
    def covered(self) -> bool | None:
        """Whether the interval contains the truth; None where there is no estimate."""
        return None if np.isnan(self.estimate) else self.low <= self.truth <= self.high


def score_stiffness(estimate: StiffnessEstimate, truth_folder: Path) -> tuple[Score, ...]:
    """Hold an estimate of the stiffness against the truth of a simulated campaign.

    Raises:
        InputError: The truth holds no stiffness for a joint of the estimate.
    """
    truth = _true_values(truth_folder, [f"stiffness.{name}" for name in estimate.joint_names])
    return tuple(
        Score(name, true.unit, true.value, float(value), float(low), float(high))
        for name, true, value, (low, high) in zip(
            estimate.joint_names, truth, estimate.stiffness, estimate.interval(), strict=True
        )
    )


def score_counterbalance(fit: CounterbalanceFit, truth_folder: Path) -> tuple[Score, ...]:
    """Hold C and l_c against the truth of a simulated campaign.

    Raises:
        InputError: The truth holds no counterbalance.
    """
    estimates = {"counterbalance.constant": fit.gas_constant, "counterbalance.critical_length": fit.critical_length}
    truth = _true_values(truth_folder, estimates)
    return tuple(
        Score(name, true.unit, true.value, value, float(low), float(high))
        for (name, value), true, (low, high) in zip(estimates.items(), truth, fit.intervals, strict=True)
    )


def as_json(scores: Iterable[Score]) -> object:
    """Return scores as plain data; what is undefined is null."""
    return to_jsonable([asdict(score) | {"error": score.error, "covered": score.covered} for score in scores])


def _true_values(folder: Path, names: Collection[str]) -> list[TrueValue]:
    parameters = read_truth(folder).parameters
    if missing := [name for name in names if name not in parameters]:
        raise InputError(f"{folder}: holds no {' and no '.join(missing)}; it belongs to another robot.")
    return [parameters[name] for name in names]
