"""What a model switches off and no machine can: gravity, its drives, its springs.

MuJoCo computes such a model, and so an arm without weight would be believed. Only what the bench relies on is looked
at; contact, for instance, may well be off.
"""

from collections.abc import Iterator

import mujoco
import numpy as np

NEEDED = ("gravity", "actuation", "spring", "damper", "frictionloss", "limit", "constraint")  # names of <flag>

LITTLE = 1e-3  # of all that moves; masses of links are not known better


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
    for body, what in _raised(spec, model):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)
        yield f"<compiler>: bound{what} raises the {what} of body {name!r}; take it out, and write what the body has."
    if spec.compiler.settotalmass > 0:
        yield "<compiler>: settotalmass scales all masses whenever a part is added; write the masses themselves."


def _raised(spec: mujoco.MjSpec, model: mujoco.MjModel) -> Iterator[tuple[int, str]]:
    """Yield bodies of which the compiler made more than is written down: the first of mass, the first of inertia.

    What is raised is raised to the bound itself. Masses may be raised by next to nothing.
    """
    moves = model.body_weldid != 0
    for what, bound in (("mass", spec.compiler.boundmass), ("inertia", spec.compiler.boundinertia)):
        least = np.min(getattr(model, f"body_{what}").reshape(model.nbody, -1), axis=1)
        raised = np.flatnonzero((least == bound) & moves)
        is_little = what == "mass" and bound * len(raised) < LITTLE * float(model.body_mass[moves].sum())
        if bound > 0 and len(raised) and not is_little:
            yield int(raised[0]), what
