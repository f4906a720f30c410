"""Compensation of the joints' compliance (section 6): subtract the predicted deformation from the commanded angles.

The commands q - N u put the links at q if u is what the elastic elements carry there. u is the whole torque: the
load, and what weight and counterbalance put on the joints unloaded, since the error of a path is counted from the
commanded line. The current method has all of it in its currents; the others take it from the model.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from bench.identify.estimate import StiffnessEstimate
from bench.identify.line_deflection import (
    LineModel,
    Prediction,
    at_commands,
    parameter_covariance,
    wind_up,
)
from bench.identify.line_passes import WAYS
from bench.identify.statics import SecondOrder
from bench.robot.bodies import Array

KNOTS = 31
WINDOW = 0.1  # of the line, over which a parabola smooths the noise of the currents


@dataclass(frozen=True)
class WayCompensation:
    """Compensation on one way; T places, K knots.

    Attributes:
        torque: Shape (T, n) [Nm], u that it counts on.
        knots: Shape (K, n) [rad], corrections at evenly spaced places from the start of the line to its end.
        removed: Displacement of the reference point that it takes away, with the estimate's uncertainty.
    """

    torque: Array
    knots: Array
    removed: Prediction


@dataclass(frozen=True)
class Compensation:
    """Corrections of the commands by one method.

    Attributes:
        method: Name of the method.
        compliance: Shape (n,) [rad/Nm] that it uses; zero where the estimate knows none.
        share: Shape (K,), places of the knots, 0 to 1.
        ways: "out" and "back" -> corrections.
    """

    method: str
    compliance: Array
    share: Array
    ways: dict[str, WayCompensation]


def compensation(model: LineModel, estimate: StiffnessEstimate) -> Compensation:
    """Return the corrections that take the deformation of the loaded passes out, as the method of an estimate sees it.

    Raises:
        InputError: The campaign has not both loaded passes.
    """
    compliance = np.nan_to_num(estimate.compliance)
    covariance = parameter_covariance(estimate, model.passes.current_gain)
    ways = {}
    for way in WAYS:
        line_pass = at_commands(model.passes.of("loaded", way))
        given = wind_up(model, estimate, "loaded", way, SecondOrder.NONE, line_pass)
        moved = given.motion.per_motor_angle @ (compliance * given.torque)[..., None]
        removed = Prediction(estimate.method, moved[..., 0], given.per_parameter, covariance, given.noise)
        ways[way] = WayCompensation(given.torque, _smooth_knots(-compliance * given.torque), removed)
    return Compensation(estimate.method, compliance, np.linspace(0, 1, KNOTS), ways)


def _smooth_knots(values: Array) -> Array:
    """Return curves, shape (T, n), smoothed and at evenly spaced knots, shape (KNOTS, n)."""
    places = len(values)
    window = min(max(5, 2 * round(WINDOW * places / 2) + 1), places - 1 + places % 2)
    smooth = savgol_filter(values, window, polyorder=2, axis=0)
    here, wanted = np.linspace(0, 1, places), np.linspace(0, 1, KNOTS)
    return np.stack([np.interp(wanted, here, column) for column in smooth.T], axis=1)
