"""What was fitted anew in a recording, beside what the model has of it: the fit tells the difference of the two."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.diagnose.cross_validation.figures import FittedFigure
from bench.predict.another_payload import carried_by
from bench.robot.compiled import CompiledRobot

AXES = "xyz"


@dataclass(frozen=True)
class FreedFigure(FittedFigure):
    """One value that was fitted anew: `found`, `low` and `high` are differences from what the model has.

    The interval is that of the difference between the recordings, this one and those that the model was made of.

    Attributes:
        model: What the model has, in `unit`; nan where it has no such number.
        total_low, total_high: 95 % interval of `total`; nan where nobody knows how well the model is known.
    """

    model: float = float("nan")
    total_low: float = float("nan")
    total_high: float = float("nan")

    @property
    def total(self) -> float:
        """What the recording has of it, in `unit`: that of the model and the difference; nan where that is unknown."""
        return self.model + self.found


def beside_model(figure: FittedFigure, in_all: FittedFigure | None, known: Mapping[str, float]) -> FreedFigure:
    """Return a figure with what the model has of it, as of `known_of`.

    Args:
        figure: With the interval of its difference.
        in_all: With that of both together, less what the model has; None where the model is taken as exact.
        known: What the model has.
    """
    model = known.get(figure.name, np.nan)
    low, high = (in_all.low, in_all.high) if in_all else (np.nan, np.nan)
    return FreedFigure(**vars(figure), model=model, total_low=model + low, total_high=model + high)


def known_of(compiled: CompiledRobot) -> Mapping[str, float]:
    """Return name of a fitted figure -> what a robot has of it, SI, of those that differences add to.

    Names are those of `nuisances_of` and of the parameters of `AnotherPayload`.
    """
    figures, readings = compiled.robot.figures, compiled.robot.figures.fitted.readings
    known = {"thermometer of the gas": readings.gas_thermometer_k}
    for j, drive in enumerate(figures.drives):
        known[f"zero of link encoder {j + 1}"] = readings.link_encoder_zero_rad.get(drive.joint, 0.0)
        known[f"current offset of {drive.joint}"] = readings.current_offset_a.get(drive.joint, 0.0)
        known[f"torque offset of {drive.joint}"] = readings.torque_offset_nm.get(drive.joint, 0.0)
    for i, axis in enumerate(AXES):
        known[f"tracker frame, shift {axis}"] = readings.tracker_shift_m[i]
        known[f"tracker frame, turn {axis}"] = readings.tracker_turn_rad[i]
        known[f"tracker drift {axis}"] = readings.tracker_drift_m_per_h[i]
        known[f"tilt of the force sensor, {axis}"] = readings.force_tilt_rad[i]
        for k, site in enumerate(figures.reflectors):
            nest = readings.nest_m.get(site)
            known[f"nest of reflector {k + 1}, {axis}"] = nest[i] if nest else 0.0
    return {**known, **carried_by(compiled)}
