"""What a model switches off and no machine can: gravity, its drives, its springs.

MuJoCo computes such a model, and so an arm without weight would be believed. Only what the bench relies on is looked
at; contact, for instance, may well be off.
"""

from collections.abc import Iterator

import mujoco
import numpy as np

NEEDED = ("gravity", "actuation", "spring", "damper", "frictionloss", "limit", "constraint")  # names of <flag>


def switched_off(spec: mujoco.MjSpec, model: mujoco.MjModel) -> Iterator[str]:
    """Yield a sentence for each law that a model switches off, or takes away from a body.

    Args:
        spec: Of the model, compiled.
        model: It.
    """
    for name in NEEDED:
        if model.opt.disableflags & getattr(mujoco.mjtDisableBit, f"mjDSBL_{name.upper()}"):
            yield f"<flag>: {name} is off; take it out, for a robot has it."
    if model.opt.disableactuator:
        yield "<option>: actuatorgroupdisable takes drives away; take it out."
    for body in np.flatnonzero(model.body_gravcomp).tolist():
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)
        words = "gravcomp holds its weight without a drive"
        yield f"body {name!r}: {words}; take it out, or model what holds it."
    if spec.compiler.settotalmass > 0:
        yield "<compiler>: settotalmass scales all masses whenever a part is added; write the masses themselves."
