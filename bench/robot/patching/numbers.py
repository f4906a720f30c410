"""How numbers of an `MjSpec` are written into a compiled model.

A number is only written where the compiled model holds the spec's own value. Where the compiler derived it from
something else, such as a mass from shapes or a place within a frame, the model is compiled.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.checks import JOINT_KINDS

LEAST_MASS = 1e-12  # [kg] or [kg m^2]; the compiler refuses less in a moving body; MuJoCo's mjMINVAL is 1e-15
SAME_FRAME = 1e-6  # [m]; within which MuJoCo takes two frames for one
UNSET_LENGTH = -1.0  # of a spring: its length with all joints at zero
EIGENVALUES = 1e-12  # relative; to which the compiler and mju_eig3 agree
SAME_BODY, SAME_INERTIA, SAME_BODY_TURN, SAME_INERTIA_TURN = (
    int(getattr(mujoco.mjtSameFrame, f"mjSAMEFRAME_{name}")) for name in ("BODY", "INERTIA", "BODYROT", "INERTIAROT")
)


class NotPatchableError(Exception):
    """An edit does what only compiling can do; the message says what."""


@dataclass(frozen=True)
class Patch:
    """One attribute of a kind of part.

    Attributes:
        write: Writes a value into a model, at the part's id. Raises NotPatchableError for a value that the compiler
            would not just copy.
        held: Whether a compiled model, at the part's id, holds a value of the spec as it is.
        moves: Bodies or points are elsewhere then.
        derives: The model holds numbers that MuJoCo derives from this one (`mj_setConst`).
    """

    write: Callable[[mujoco.MjModel, int, Any], None]
    held: Callable[[mujoco.MjModel, int, Any], bool]
    moves: bool = False
    derives: bool = True


def _copied(field: str, check: Callable[[mujoco.MjModel, int, Any], None] | None = None, **flags: bool) -> Patch:
    def write(model: mujoco.MjModel, index: int, value: Any) -> None:
        if check:
            check(model, index, value)
        getattr(model, field)[index] = value

    return Patch(write, lambda model, index, value: np.array_equal(getattr(model, field)[index], value), **flags)


def _polynomial(first: str, higher: str, check: Callable[[float], None] | None = None) -> Patch:
    """Return the patch of a coefficient and those of higher powers, which the model holds apart."""

    def write(model: mujoco.MjModel, index: int, value: NDArray[np.float64]) -> None:
        if check:
            check(float(value[0]))
        getattr(model, first)[index] = value[0]
        getattr(model, higher)[index] = value[1:]

    def held(model: mujoco.MjModel, index: int, value: NDArray[np.float64]) -> bool:
        return bool(getattr(model, first)[index] == value[0]) and np.array_equal(
            getattr(model, higher)[index], value[1:]
        )

    return Patch(write, held, derives=False)


def _on_dof(patch: Patch) -> Patch:
    """Return the patch of a joint whose numbers stand at its degree of freedom."""

    def dof(model: mujoco.MjModel, joint: int) -> int:
        return int(model.jnt_dofadr[joint])

    return Patch(
        lambda model, joint, value: patch.write(model, dof(model, joint), value),
        lambda model, joint, value: (
            int(model.jnt_type[joint]) in JOINT_KINDS and patch.held(model, dof(model, joint), value)
        ),
        patch.moves,
        patch.derives,
    )


def _positive(value: float) -> None:
    if not value > 0:
        raise NotPatchableError("a stiffness of an elastic element that is not positive")


def _armature(model: mujoco.MjModel, dof: int, value: float) -> None:
    if not value > 0:
        raise NotPatchableError("an armature that is not positive")


def _mass(model: mujoco.MjModel, body: int, value: float) -> None:
    if not value >= (LEAST_MASS if model.body_dofnum[body] else 0.0):
        raise NotPatchableError("a mass that the compiler may refuse")


def _inertia(model: mujoco.MjModel, body: int, value: NDArray[np.float64]) -> None:
    least = LEAST_MASS if model.body_dofnum[body] else 0.0
    if not (np.all(value >= least) and 2 * np.max(value) <= np.sum(value)):
        raise NotPatchableError("an inertia that the compiler may refuse")


def _write_full_inertia(model: mujoco.MjModel, body: int, value: NDArray[np.float64]) -> None:
    inertia, turned = _principal(value)
    if not _same_turn(model.body_iquat[body], turned):
        raise NotPatchableError("principal axes that turn")
    _inertia(model, body, inertia)
    model.body_inertia[body] = inertia


def _holds_full_inertia(model: mujoco.MjModel, body: int, value: NDArray[np.float64]) -> bool:
    inertia, turned = _principal(value)
    return np.allclose(model.body_inertia[body], inertia, rtol=EIGENVALUES, atol=0.0) and _same_turn(
        model.body_iquat[body], turned
    )


def _principal(value: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the principal moments of an inertia (xx, yy, zz, xy, xz, yz) and the quaternion of their axes."""
    return _principal_of(*value.tolist())


@lru_cache(maxsize=256)  # models of one fit have most inertias in common
def _principal_of(
    xx: float, yy: float, zz: float, xy: float, xz: float, yz: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    moments, axes, turned = np.empty(3), np.empty(9), np.empty(4)
    mujoco.mju_eig3(moments, axes, turned, np.array([xx, xy, xz, xy, yy, yz, xz, yz, zz]))
    return moments, turned


def _same_turn(first: NDArray[np.float64], second: NDArray[np.float64]) -> bool:
    return bool(abs(first @ second) > 1 - EIGENVALUES)


def _not_simple(model: mujoco.MjModel, joint: int, value: NDArray[np.float64]) -> None:
    if model.body_simple[model.jnt_bodyid[joint]]:
        raise NotPatchableError("a joint of a body with a diagonal mass matrix")


def _write_axis(model: mujoco.MjModel, joint: int, value: NDArray[np.float64]) -> None:
    _not_simple(model, joint, value)
    model.jnt_axis[joint] = value / np.linalg.norm(value)


def _write_spring_length(model: mujoco.MjModel, tendon: int, value: NDArray[np.float64]) -> None:
    if value[0] > value[1] or value[0] == UNSET_LENGTH:
        raise NotPatchableError("a spring length that the compiler refuses or derives")
    model.tendon_lengthspring[tendon] = value


def _write_gravity(model: mujoco.MjModel, index: int, value: NDArray[np.float64]) -> None:
    model.opt.gravity[:] = value


def _write_wrap(model: mujoco.MjModel, tendon: int, value: tuple[int, float]) -> None:
    place, coefficient = value
    model.wrap_prm[model.tendon_adr[tendon] + place] = coefficient


PATCHES = {
    ("body", "mass"): _copied("body_mass", _mass),
    ("body", "inertia"): _copied("body_inertia", _inertia),
    ("body", "fullinertia"): Patch(_write_full_inertia, _holds_full_inertia),
    ("body", "pos"): _copied("body_pos", moves=True),
    ("body", "ipos"): _copied("body_ipos", moves=True),
    ("joint", "armature"): _on_dof(_copied("dof_armature", _armature)),
    ("joint", "damping"): _on_dof(_polynomial("dof_damping", "dof_dampingpoly")),
    ("joint", "stiffness"): _polynomial("jnt_stiffness", "jnt_stiffnesspoly"),
    ("joint", "pos"): _copied("jnt_pos", _not_simple, moves=True),
    ("joint", "axis"): Patch(
        _write_axis, lambda model, i, value: np.allclose(model.jnt_axis[i], value / np.linalg.norm(value)), moves=True
    ),
    ("tendon", "stiffness"): _polynomial("tendon_stiffness", "tendon_stiffnesspoly", _positive),
    ("tendon", "damping"): _polynomial("tendon_damping", "tendon_dampingpoly"),
    ("tendon", "springlength"): Patch(
        _write_spring_length,
        lambda model, i, value: bool(value[0] == UNSET_LENGTH) or np.array_equal(model.tendon_lengthspring[i], value),
        derives=False,
    ),
    ("tendon", "wrap"): Patch(_write_wrap, lambda model, i, value: True, moves=True),
    ("site", "pos"): _copied("site_pos", moves=True),
    ("option", "gravity"): Patch(
        _write_gravity, lambda model, i, value: np.array_equal(model.opt.gravity, value), derives=False
    ),
}


def set_frames(model: mujoco.MjModel, bodies: set[int], sites: set[int]) -> None:
    """Set the flags that say which frames coincide, after the inertial frames of some bodies and some sites moved.

    Raises:
        NotPatchableError: The compiler would now take a body for a simpler or a less simple one.
    """
    turns_with_body = (SAME_BODY, SAME_BODY_TURN)
    for body in bodies:
        before = int(model.body_sameframe[body])
        if before in turns_with_body:
            flag = SAME_BODY if _is_zero(model.body_ipos[body]) else SAME_BODY_TURN
            if flag != before or model.body_simple[body]:
                raise NotPatchableError("an inertial frame that comes into the body's frame, or leaves it")
        if model.body_geomnum[body]:
            raise NotPatchableError("the inertial frame of a body with shapes")
        sites = sites | set(np.flatnonzero(model.site_bodyid == body).tolist())
    for site in sites:
        body, before = int(model.site_bodyid[site]), int(model.site_sameframe[site])
        inertia_is_unturned = int(model.body_sameframe[body]) in turns_with_body
        is_unturned = before in turns_with_body or (before == SAME_INERTIA and inertia_is_unturned)
        at_inertia = _is_zero(model.site_pos[site] - model.body_ipos[body])
        if is_unturned:
            same = SAME_INERTIA if at_inertia and inertia_is_unturned else SAME_BODY_TURN
            model.site_sameframe[site] = SAME_BODY if _is_zero(model.site_pos[site]) else same
        elif before in (SAME_INERTIA, SAME_INERTIA_TURN):
            model.site_sameframe[site] = SAME_INERTIA if at_inertia else SAME_INERTIA_TURN


def _is_zero(step: NDArray[np.float64]) -> bool:
    return bool(np.all(np.abs(step) < SAME_FRAME))
