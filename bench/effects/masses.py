"""Masses and inertias of links and drives, and constant torques, that differ from the model's."""

from dataclasses import replace

import mujoco
import numpy as np

from bench.actuators.laws import TorqueTable
from bench.effects.conditions import Conditions
from bench.effects.effect import Array, Effect, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.places import OnDrive, drive_of, links, most_torque
from bench.effects.plugin_actuators import add_torque_table
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

# assumed: [rad/s^2] or [m/s^2], at least, with which a drive's torque limit spins up its own rotor: 16 to 63 on the
# KR300, the heaviest of our arms; lighter ones spin up faster
SLOWEST_SPIN = 16.0
LIGHTEST = -0.95  # rounding: change of a mass or an inertia, relative; none vanishes
# rounding: the same of a rotor, which may be a guess: torque sensors behind the gear feel none at all
LIGHTEST_ROTOR = -0.999
SWEVERS = "Swevers, Verdonck and De Schutter, Dynamic model identification for industrial robots, 2007"


class GeometryAndMass(Effect):
    """What weighs, or acts as a weight does."""

    family = "geometry and mass"


class _OfLink(GeometryAndMass):
    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return links(compiled)


class LinkMass(_OfLink):
    """A link is heavier or lighter than in the model."""

    name = "link_mass"
    title = "mass of a link"
    physics = "Mass and inertia of a body become (1 + x) of the model's; its centre of mass stays."
    source = f"{SWEVERS}; range: CAD against weighed, with cables and grease, assumed"
    parameters = (Parameter("change", "", 0.0, 0.03, 0.3, "of the mass, relative", signed=True, least=LIGHTEST),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]
        return (lambda spec, robot: scale_mass(spec.body(place.name), 1 + change)) if change else None


class LinkCom(_OfLink):
    """A link's centre of mass is elsewhere."""

    name = "link_com"
    title = "centre of mass of a link"
    physics = "The centre of mass of a body is moved by (x, y, z) in the body's axes; its inertia about it stays."
    source = f"{SWEVERS}; range: CAD against identified, assumed"
    parameters = tuple(Parameter(axis, "m", 0.0, 3e-3, 50e-3, f"shift along {axis}", signed=True) for axis in "xyz")

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        shift = vector_of(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            body = spec.body(place.name)
            body.ipos = np.array(body.ipos) + shift

        return change if np.any(shift) else None


class LinkInertia(_OfLink):
    """A link's inertia about its centre of mass is not the model's."""

    name = "link_inertia"
    title = "inertia of a link"
    physics = (
        "The moments of inertia of a body about its centre of mass become (1 + x) of the model's; it is felt in "
        "acceleration only."
    )
    source = f"{SWEVERS}; range: assumed"
    parameters = (
        Parameter("change", "", 0.0, 0.05, 0.5, "of the moments of inertia, relative", signed=True, least=LIGHTEST),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]

        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            _scale_inertia(spec.body(place.name), 1 + change)

        return edit if change else None


class RotorInertia(OnDrive):
    """The reflected inertia of motor and gear is not the model's."""

    name = "rotor_inertia"
    family = "geometry and mass"
    title = "inertia of motor and gear"
    physics = "J_m N^2 of a drive becomes (1 + x) of the model's; it is felt in acceleration only."
    source = (
        f"{SWEVERS}; range: data sheet against identified, brake and gear left out, assumed; where more, up to "
        "what the drive can spin up, for rotors of public models are often placeholders"
    )
    parameters = (Parameter("change", "", 0.0, 0.03, 0.5, "relative", signed=True, least=LIGHTEST_ROTOR),)

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the change, up to the heaviest rotor that the drive's torque limit spins up."""
        (change,) = self.parameters
        stated = float(compiled.model.dof_armature[compiled.at.q_dof[place.index]])
        heaviest = most_torque(compiled, place.index) / SLOWEST_SPIN
        return (replace(change, high=max(change.high, heaviest / stated - 1)),) if stated > 0 else (change,)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]

        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            joint = spec.joint(drive_of(robot, place).rotor)
            joint.armature = (1 + change) * joint.armature

        return edit if change else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        compiled = followed.compiled
        inertia = float(compiled.model.dof_armature[compiled.at.q_dof[place.index]])
        return Torques(motor=-values["change"] * inertia * followed.acceleration[:, place.index])


class TorqueOffset(OnDrive):
    """A constant torque acts on a joint."""

    name = "torque_offset"
    family = "geometry and mass"
    title = "constant torque on a joint"
    physics = (
        "Something pulls on a joint with the same torque at every angle and speed (an unmodelled weight, a spring"
        " at long "
        "travel); it acts on the link, in the direction of growing angle."
    )
    source = (
        "Janot, Gautier and Brunot, data set of the EMPS, 2019 (offset force); range: 0.05 to 5 % of the limit, assumed"
    )
    is_additive = True
    parameters = (Parameter("torque", "Nm", 0.0, 5.0, 500.0, "range for a drive of 10 kNm", signed=True),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        torque = values["torque"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            law = TorqueTable(angle_min=-1.0, angle_max=1.0, forward=(torque, torque), backward=(torque, torque))
            add_torque_table(spec, f"torque on {place.name}", law, joint=place.name)

        return change if torque else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return Torques(link=values["torque"])


def scale_mass(body: mujoco.MjsBody, factor: float) -> None:
    """Multiply mass and inertia of a body."""
    body.mass = factor * body.mass
    _scale_inertia(body, factor)


def _scale_inertia(body: mujoco.MjsBody, factor: float) -> None:
    body.inertia = factor * np.array(body.inertia)
    body.fullinertia = factor * np.array(body.fullinertia)


def vector_of(values: Values, prefix: str = "") -> Array:
    """Return the parameters x, y and z, whose names may begin with a prefix, shape (3,)."""
    return np.array([values[prefix + axis] for axis in "xyz"])
