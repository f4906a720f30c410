"""Lengths, zeros and places that differ from the drawing."""

import mujoco
import numpy as np

from bench.actuators.laws import TorqueTable
from bench.effects.conditions import REFERENCE_K, Conditions
from bench.effects.effect import Array, Effect, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.gear_kinematics import table_range
from bench.effects.nominal import moving_bodies
from bench.effects.places import SHORT, OnDrive
from bench.effects.plugin_actuators import add_torque_table
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

NUBIOLA = "Nubiola and Bonev, Absolute calibration of an ABB IRB 1600 robot using a laser tracker, 2013"


class JointZero(OnDrive):
    """A motor's zero mark is off."""

    name = "joint_zero"
    family = "geometry and mass"
    title = "zero of a joint"
    physics = "After a mastering error the encoder reads q + x, so the servo holds the motor at command - x."
    source = f"{NUBIOLA}; range: design of this project, 0.005 to 0.1 deg"
    parameters = (Parameter("offset", "rad", 0.0, 8.7e-5, 1.75e-3, "reading less truth", signed=True),)

    def encoder_error(self, place: Place, values: Values, q: Array, velocity: Array) -> Array | None:
        offset = values["offset"]
        if not offset:
            return None
        error = np.zeros_like(q)
        error[:, place.index] = offset
        return error


class LinkLength(Effect):
    """A link is longer or shorter than drawn."""

    name = "link_length"
    family = "geometry and mass"
    title = "length of a link"
    physics = "A body stands x further out along the line from its parent's frame: machining and assembly."
    source = f"{NUBIOLA}; range: design of this project, 0.1 to 1 mm"
    parameters = (Parameter("longer", "m", 0.0, 1e-4, 1e-3, "beyond the drawing", signed=True),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the bodies with a driven joint or a reflector that do not stand in their parent's origin."""
        model, at = compiled.model, compiled.at
        placed = {*model.jnt_bodyid[at.joint].tolist(), *model.site_bodyid[at.reflectors].tolist()}
        bodies = [model.body(name) for name in moving_bodies(compiled)]
        return tuple(
            Place("body", int(body.id), str(body.name))
            for body in bodies
            if int(body.id) in placed and np.linalg.norm(body.pos) > SHORT
        )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        longer = values["longer"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            body = spec.body(place.name)
            position = np.array(body.pos)
            body.pos = position * (1 + longer / np.linalg.norm(position))

        return change if longer else None


class ThermalGrowth(Effect):
    """Warm links are longer."""

    name = "thermal_growth"
    family = "geometry and mass"
    title = "thermal growth of the links"
    physics = (
        "A link of length L grows by alpha L (T - 293.15 K). T lies between the air and the mean of the gearboxes, "
        "T = (1 - w) T_ambient + w T_gear. Gearboxes whose temperature nobody measured are as warm as the air."
    )
    source = "ISO 230-3, thermal effects; alpha of steel 11.5 ppm/K, of aluminium 23 ppm/K (table values); w assumed"
    parameters = (
        Parameter("expansion", "1/K", 0.0, 8e-6, 2.4e-5, "alpha that the nominal model leaves out"),
        Parameter("soak", "", 0.5, 0.0, 1.0, "w, share of the gearboxes in the links' temperature", is_shape=True),
    )
    needs = ("ambient_temperature",)
    depends_on_conditions = True

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        soak = values["soak"]
        rise = (1 - soak) * conditions.ambient_k + soak * float(np.mean(conditions.gear_k)) - REFERENCE_K
        strain = values["expansion"] * rise

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            first = _body_of(spec, robot.figures.drives[0].joint)
            for body in [first, *first.find_all("body")]:
                for part in [*([] if body is first else [body]), *body.sites]:
                    part.pos = np.array(part.pos) * (1 + strain)
                body.ipos = np.array(body.ipos) * (1 + strain)

        return change if strain else None


class DressPack(OnDrive):
    """Cables and hoses pull on a joint."""

    name = "dress_pack"
    family = "geometry and mass"
    title = "dress pack"
    physics = "Cables and hoses along the arm act like a spring on a joint: torque = -c (theta - theta_0)."
    source = "range: design of this project, 5 to 100 Nm over about a radian; form assumed"
    is_additive = True
    parameters = (
        Parameter("stiffness", "Nm/rad", 0.0, 5.0, 100.0, "c; range for a drive of 10 kNm"),
        Parameter("neutral", "rad", 0.0, -1.5, 1.5, "theta_0, where it does not pull", is_shape=True),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        stiffness, neutral = values["stiffness"], values["neutral"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            # a table, since `springref` would move the zero of the elastic element too
            law = TorqueTable.of(lambda x: -stiffness * (x - neutral), *table_range(spec, place.name), 2)
            add_torque_table(spec, f"dress pack {place.name}", law, joint=place.name)

        return change if stiffness else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return Torques(link=-values["stiffness"] * (followed.trace.theta[:, place.index] - values["neutral"]))


def _body_of(spec: mujoco.MjSpec, joint: str) -> mujoco.MjsBody:
    return spec.joint(joint).parent


class FloorTilt(Effect):
    """The robot does not stand level."""

    name = "floor_tilt"
    family = "geometry and mass"
    title = "floor out of level"
    physics = "The base frame, in which the tracker measures, leans: in it, gravity points aside by (x, y) rad."
    source = "ISO 9283 asks for a base as the maker says, commonly level to 0.1 to 0.5 deg; range: assumed"
    parameters = (
        Parameter("x", "rad", 0.0, 1e-3, 1e-2, "lean towards x", signed=True),
        Parameter("y", "rad", 0.0, 1e-3, 1e-2, "lean towards y", signed=True),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        lean = np.array([values["x"], values["y"]])

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            gravity = np.array(spec.option.gravity)
            size = float(np.linalg.norm(gravity))
            if size:
                direction = gravity / size + np.array([*lean, 0.0])
                spec.option.gravity = size * direction / np.linalg.norm(direction)

        return change if np.any(lean) else None
