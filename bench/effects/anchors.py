"""Where the counterbalance's cylinder is hung up."""

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Array, Effect, Parameter, Place, Values
from bench.effects.geometry_at_zero import AtZero, across
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot


class Anchor(Effect):
    """The anchors of the cylinder are not where the drawing has them."""

    name = "anchor"
    family = "gas and cylinder"
    title = "anchors of the cylinder"
    physics = (
        "Fixed anchor at (a, h) and moving anchor at b from the joint make l^2 = b^2 + rho^2 - 2 b rho cos(theta "
        "- alpha), "
        "Eqs. (9), (10), with rho^2 = a^2 + h^2; an error in one of them changes length, lever arm and dead centre."
    )
    source = (
        "Eqs. (9) and (10) of the paper; range: design of this project, 1 to 5 mm (casting and pin tolerances, assumed)"
    )
    parameters = (
        Parameter("a", "m", 0.0, 1e-3, 5e-3, "horizontal distance of the fixed anchor from the joint", signed=True),
        Parameter("b", "m", 0.0, 1e-3, 5e-3, "distance of the moving anchor from the joint", signed=True),
        Parameter("h", "m", 0.0, 1e-3, 5e-3, "vertical distance of the fixed anchor from the joint", signed=True),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return (WHOLE,) if compiled.counterbalance else ()

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        a, b, h = values["a"], values["b"], values["h"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            balance = robot.figures.counterbalance
            assert balance
            zero = AtZero(spec)
            fixed, moving = zero.ends(balance.tendon, balance.joint)
            joint, axis = zero.anchor(balance.joint), zero.axis(balance.joint)
            horizontal, vertical = _plane(axis, np.array(zero.model.opt.gravity))
            arm = zero.site(fixed) - joint
            step = a * _outward(horizontal, arm) + h * _outward(vertical, arm)
            lever = zero.site(moving) - joint
            lever = lever - axis * (lever @ axis)
            _shift(spec, zero, fixed, step)
            _shift(spec, zero, moving, b * lever / np.linalg.norm(lever))

        return change if a or b or h else None


def _plane(axis: Array, gravity: Array) -> tuple[Array, Array]:
    """Return two unit vectors in the plane across an axis, the second one as vertical as it can be."""
    vertical = gravity - axis * (gravity @ axis)
    size = float(np.linalg.norm(vertical))
    if size < 1e-6 * max(float(np.linalg.norm(gravity)), 1.0):
        return across(axis)
    return np.cross(axis, vertical / size), vertical / size


def _outward(direction: Array, arm: Array) -> Array:
    return direction if direction @ arm >= 0 else -direction


def _shift(spec: mujoco.MjSpec, zero: AtZero, site: str, step: Array) -> None:
    point = spec.site(site)
    point.pos = np.asarray(point.pos) + zero.direction_in_body_of_site(site, step)
