"""Estimate against truth. The only module that opens the truth."""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from bench.errors import InputError
from bench.identify.counterbalance_fit import CounterbalanceFit
from bench.identify.estimate import StiffnessEstimate
from bench.record.truth import read_truth


@dataclass(frozen=True)
class JointScore:
    """One joint of one estimate beside the truth.

    Attributes:
        joint: Name.
        truth: [Nm/rad].
        estimate: [Nm/rad], nan where the data cannot tell.
        low, high: Ends of the interval [Nm/rad].
        error: Relative, estimate / truth - 1.
        covered: Whether the interval contains the truth; None where there is no estimate.
    """

    joint: str
    truth: float
    estimate: float
    low: float
    high: float
    error: float
    covered: bool | None


def score_stiffness(estimate: StiffnessEstimate, truth_folder: Path, level: float = 0.95) -> tuple[JointScore, ...]:
    """Hold an estimate of the stiffness against the truth of a simulated campaign.

    Raises:
        InputError: The truth holds no stiffness for a joint of the estimate.
    """
    parameters = read_truth(truth_folder).parameters
    if missing := [name for name in estimate.joint_names if f"stiffness.{name}" not in parameters]:
        raise InputError(f"{truth_folder}: holds no stiffness of {', '.join(missing)}; it belongs to another robot.")
    scores = []
    for name, value, (low, high) in zip(
        estimate.joint_names, estimate.stiffness, estimate.interval(level), strict=True
    ):
        true = parameters[f"stiffness.{name}"].value
        covered = None if np.isnan(value) else bool(low <= true <= high)
        scores.append(JointScore(name, true, float(value), float(low), float(high), float(value / true - 1), covered))
    return tuple(scores)


def as_json(scores: tuple[JointScore, ...]) -> list[dict[str, object]]:
    """Return scores as plain data; what is undefined is null."""
    return [
        {key: None if isinstance(value, float) and np.isnan(value) else value for key, value in asdict(score).items()}
        for score in scores
    ]


@dataclass(frozen=True)
class ParameterScore:
    """One identified parameter beside the truth.

    Attributes:
        name: Of the parameter, as in the truth.
        unit: Of all numbers.
        truth: As simulated.
        estimate: As identified.
        low, high: Ends of the interval.
        error: Relative, estimate / truth - 1.
        covered: Whether the interval contains the truth.
    """

    name: str
    unit: str
    truth: float
    estimate: float
    low: float
    high: float
    error: float
    covered: bool


def score_counterbalance(fit: CounterbalanceFit, truth_folder: Path) -> tuple[ParameterScore, ...]:
    """Hold C and l_c against the truth of a simulated campaign.

    Raises:
        InputError: The truth holds no counterbalance.
    """
    parameters = read_truth(truth_folder).parameters
    estimates = {"counterbalance.constant": fit.gas_constant, "counterbalance.critical_length": fit.critical_length}
    if missing := [name for name in estimates if name not in parameters]:
        raise InputError(f"{truth_folder}: holds no {' and no '.join(missing)}; it belongs to another robot.")
    scores = []
    for (name, value), (low, high) in zip(estimates.items(), fit.intervals, strict=True):
        true, unit = parameters[name].value, parameters[name].unit
        scores.append(
            ParameterScore(
                name, unit, true, value, float(low), float(high), value / true - 1, bool(low <= true <= high)
            )
        )
    return tuple(scores)
