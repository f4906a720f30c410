"""Systematic errors of instruments as fitted to measured campaigns (`fitted.readings` of a robot's figures)."""

import numpy as np
from numpy.typing import NDArray

from bench.robot.figures import Figures

Array = NDArray[np.float64]


def fitted_errors(figures: Figures) -> dict[str, Array | float]:
    """Return what `fitted.readings` adds to the fields of `SystematicErrors`, by their names.

    A thermometer in the gas is not among them: it belongs to the lab, and `Instruments` has none.
    """
    readings = figures.fitted.readings
    joints = [drive.joint for drive in figures.drives]

    def by_joint(given: dict[str, float]) -> Array:
        return np.array([given.get(joint, 0.0) for joint in joints])

    nests = [readings.nest_m.get(site, (0.0, 0.0, 0.0)) for site in figures.reflectors]
    return {
        "current_gain": by_joint(readings.current_gain),
        "current_offset": by_joint(readings.current_offset_a),
        "torque_gain": by_joint(readings.torque_gain),
        "torque_offset": by_joint(readings.torque_offset_nm),
        "link_encoder_offset": by_joint(readings.link_encoder_zero_rad),
        "force_gain": readings.force_gain,
        "force_tilt": np.array(readings.force_tilt_rad),
        "frame_shift": np.array(readings.tracker_shift_m),
        "frame_rotation": np.array(readings.tracker_turn_rad),
        "frame_drift": np.array(readings.tracker_drift_m_per_h),
        "placement": np.array(nests).reshape(-1, 3),
    }
