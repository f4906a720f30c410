"""What drives report, as figures that every command knows: torque constants in `drives`, offsets in `fitted`."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.perfect_instruments import ideal_reading
from bench.diagnose.replay.world import NOMINAL
from bench.effects.effect import Acting
from bench.effects.sensing_drive import CurrentOffset, TorqueConstant
from bench.robot.figures import Drive, Figures

LINEAR = (TorqueConstant, CurrentOffset)


def with_drive_readings(figures: Figures, linear: LinearisedModel, acting: Sequence[Acting]) -> Figures:
    """Return figures in which torque constants and current offsets that are effects have become figures.

    Effects make the current I a I + b, and the fitted errors of readings (1 + g) (a I + b) + o: that is what a drive
    with the constant xi / (a (1 + g)) and the offset b (1 + g) + o reports. Where an effect that is not linear changes
    what a drive reports, effects and errors stay as they are, for their order counts.

    Args:
        figures: With everything fitted in `fitted`.
        linear: The campaign.
        acting: The effects of `figures.fitted.effects`, in their order.
    """
    is_linear = ~_changed(linear, [one for one in acting if not isinstance(one.effect, LINEAR)])
    n = len(figures.drives)
    slope, offset, of_torque = np.ones(n), np.zeros(n), np.ones(n)
    kept = []
    for one, entry in zip(acting, figures.fitted.effects, strict=True):
        j = one.place.index
        if not isinstance(one.effect, LINEAR) or not is_linear[j]:
            kept.append(entry)
        elif isinstance(one.effect, TorqueConstant):
            share = 1 + one.values["change"]
            slope[j], offset[j], of_torque[j] = slope[j] / share, offset[j] / share, of_torque[j] / share
        else:
            offset[j] += one.values["offset"]
    readings = figures.fitted.readings
    gains, offsets, torque_gains = (
        dict(readings.current_gain),
        dict(readings.current_offset_a),
        dict(readings.torque_gain),
    )
    drives: list[Drive] = []
    for j, drive in enumerate(figures.drives):
        name, gain = drive.joint, 1 + gains.get(drive.joint, 0.0)
        if offset[j]:
            offsets[name] = float(offset[j]) * gain + offsets.get(name, 0.0)
        if of_torque[j] != 1:
            torque_gains[name] = (1 + torque_gains.get(name, 0.0)) * float(of_torque[j]) - 1
        change = float(slope[j]) * gain
        if is_linear[j] and change != 1:
            gains[name] = change - 1
            if change > 0:  # else nobody's torque constant; a fit far from anything stated
                del gains[name]
                drive = drive.model_copy(update={"torque_constant_nm_per_a": drive.torque_constant_nm_per_a / change})
        drives.append(drive)
    update = {"current_gain": gains, "current_offset_a": offsets, "torque_gain": torque_gains}
    fitted = figures.fitted.model_copy(update={"readings": readings.model_copy(update=update), "effects": tuple(kept)})
    return figures.model_copy(update={"drives": tuple(drives), "fitted": fitted})


def _changed(linear: LinearisedModel, acting: Sequence[Acting]) -> NDArray[np.bool_]:
    """Return of which drives some effects change the reported current or torque, shape (n,)."""
    compiled, trace = linear.replay.compiled, linear.replay.trace(NOMINAL)
    before, found = ideal_reading(compiled, trace), np.zeros(compiled.n_joints, dtype=np.bool_)
    for conditions in {segment.conditions.key: segment.conditions for segment in linear.segments}.values():
        after = before
        for one in acting:
            after = one.effect.distort(one.place, one.values, after, trace, conditions)
        found |= np.any((after.current != before.current) | (after.torque != before.torque), axis=0)
    return found
