"""Fitted torque constants, put where every command looks for them: in `drives` of the figures."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.picture.design import Design
from bench.diagnose.replay.replay import ideal_reading
from bench.diagnose.replay.world import NOMINAL
from bench.effects.effect import Acting
from bench.effects.sensing_drive import TorqueConstant
from bench.robot.figures import Figures


def with_torque_constants(figures: Figures, design: Design, acting: Sequence[Acting]) -> Figures:
    """Return figures with fitted gains of currents and changed torque constants in `drives`.

    A current reads tau / xi (1 + g): that is the current of a drive with xi / (1 + g). Where an effect that is no
    torque constant changes what the drive reports too, the gain stays behind it, in `fitted`.

    Args:
        figures: With everything fitted in `fitted`.
        design: The campaign.
        acting: The effects of `figures.fitted.effects`, in their order.
    """
    plain = ~_changed(design, [one for one in acting if not isinstance(one.effect, TorqueConstant)])
    readings = figures.fitted.readings
    current_gain, torque_gain = dict(readings.current_gain), dict(readings.torque_gain)
    kept, drives = [], []
    share = np.ones(len(figures.drives))
    for one, entry in zip(acting, figures.fitted.effects, strict=True):
        if isinstance(one.effect, TorqueConstant) and plain[one.place.index]:
            share[one.place.index] *= 1 + one.values["change"]
        else:
            kept.append(entry)
    for drive, factor, is_plain in zip(figures.drives, share.tolist(), plain, strict=True):
        if is_plain:
            change = factor / (1 + current_gain.pop(drive.joint, 0.0))
            if change != 1:
                constant = drive.torque_constant_nm_per_a * change
                drive = drive.model_copy(update={"torque_constant_nm_per_a": constant})
            if factor != 1:
                torque_gain[drive.joint] = (1 + torque_gain.get(drive.joint, 0.0)) / factor - 1
        drives.append(drive)
    update = {"current_gain": current_gain, "torque_gain": torque_gain}
    fitted = figures.fitted.model_copy(update={"readings": readings.model_copy(update=update), "effects": tuple(kept)})
    return figures.model_copy(update={"drives": tuple(drives), "fitted": fitted})


def _changed(design: Design, acting: Sequence[Acting]) -> NDArray[np.bool_]:
    """Return of which drives some effects change the reported current or torque, shape (n,)."""
    compiled, trace = design.replay.compiled, design.replay.trace(NOMINAL)
    before = after = ideal_reading(compiled, trace)
    for one in acting:
        after = one.effect.distort(one.place, one.values, after, trace, design.segments[0].conditions)
    found: NDArray[np.bool_] = np.any((after.current != before.current) | (after.torque != before.torque), axis=0)
    return found
