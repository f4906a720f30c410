"""Friction of a drive: how high its levels are, and on which side of the elastic element it sits."""

from math import exp

import mujoco
import numpy as np

from bench.actuators.laws import ROLLING_POWER
from bench.effects.effect import REFERENCE_K, Array, Conditions, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.friction_elements import coulomb, give_side, rolling, scale_coulomb, scale_rolling, set_coulomb
from bench.effects.places import OnDrive, drive_of, drives
from bench.effects.sliding import sliding_friction
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

ARMSTRONG = (
    "Armstrong-Helouvry, Dupont and Canudas de Wit, A survey of models, analysis tools and compensation methods, 1994"
)
BITTENCOURT = (
    "Bittencourt and Gunnarsson, Static friction in a robot joint: modeling and identification of load and "
    "temperature effects, 2012"
)
PALMGREN = "Palmgren, Ball and roller bearing engineering, 1959: M_0 ~ (nu n)^(2/3) (the SKF model has the power 0.6)"


class _OnFriction(OnDrive):
    family = "drive friction"


class _WithCoulomb(_OnFriction):
    """It changes Coulomb friction that is there, so it needs some."""

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return with_coulomb(compiled)


class CoulombLevel(_WithCoulomb):
    """The level of sliding friction is not the nominal one."""

    name = "coulomb_level"
    title = "Coulomb level"
    physics = "Preload, wear and lubricant set the level of dry friction: both sides' levels become (1 + x) f_C."
    source = f"{BITTENCOURT}; range: spread between units and over life, assumed"
    parameters = (Parameter("change", "", 0.0, 0.1, 0.6, "of the level, relative", signed=True, least=-1.0),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]
        return (lambda spec, robot: scale_coulomb(spec, drive_of(robot, place), 1 + change)) if change else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return scaled_friction(place, followed, values["change"], values["change"])


class CoulombFriction(_OnFriction):
    """Dry friction where the nominal model has none."""

    name = "coulomb_friction"
    title = "Coulomb friction that the model leaves out"
    physics = (
        "Dry friction in gear, bearings and seals opposes motion with a constant torque f_C sign(v), and holds at rest "
        "within +-f_C. It is put on the motor side (the effect friction_side moves it)."
    )
    source = f"{ARMSTRONG}; range: 0.2 to 10 % of the drive's torque limit, assumed"
    is_additive = True
    parameters = (Parameter("level", "Nm", 0.0, 20.0, 1000.0, "f_C; range for a drive of 10 kNm"),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        rich = {place.index for place in with_coulomb(compiled)}
        return tuple(place for place in drives(compiled) if place.index not in rich)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        level = values["level"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            set_coulomb(spec, drive, "motor", coulomb(spec, drive, "motor") + level)

        return change if level else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        there = float(followed.compiled.motor_coulomb[place.index])
        if there > 0:
            sliding = sliding_friction(followed, "motor", place.index)
            return None if sliding is None else Torques(motor=values["level"] / there * sliding)
        if np.any(followed.visit >= 0):
            return None  # what would hold at rest is not told by a robot without friction
        return Torques(motor=-values["level"] * np.sign(followed.trace.q_velocity[:, place.index]))


class Viscous(_OnFriction):
    """The viscous coefficient is not the nominal one."""

    name = "viscous_level"
    title = "viscous friction"
    physics = "Shear of the lubricant opposes motion in proportion to speed, f = (1 + x) f_v v on the motor side."
    source = f"{BITTENCOURT}; range: lubricant and filling, assumed"
    parameters = (Parameter("change", "", 0.0, 0.1, 0.8, "of the coefficient, relative", signed=True, least=-1.0),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return tuple(place for place in drives(compiled) if viscous(compiled)[place.index] > 0)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]
        return (lambda spec, robot: scale_viscous(spec, drive_of(robot, place).rotor, 1 + change)) if change else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return _drag(place, followed, values["change"] * float(viscous(followed.compiled)[place.index]))


class ViscousFriction(_OnFriction):
    """Viscous friction where the nominal model has none."""

    name = "viscous_friction"
    title = "viscous friction that the model leaves out"
    physics = (
        "Shear of the lubricant opposes motion in proportion to speed, f = f_v v, mostly in the fast motor-side stages."
    )
    source = f"{ARMSTRONG}; range: 0.2 to 50 % of the torque limit at the speed limit, assumed"
    is_additive = True
    parameters = (
        Parameter("coefficient", "Nm s/rad", 0.0, 10.0, 2500.0, "f_v; range for a drive of 10 kNm and 2 rad/s"),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return tuple(place for place in drives(compiled) if viscous(compiled)[place.index] == 0)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        coefficient = values["coefficient"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            joint = spec.joint(drive_of(robot, place).rotor)
            joint.damping = np.asarray(joint.damping) + np.array([coefficient, 0, 0])

        return change if coefficient else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return _drag(place, followed, values["coefficient"])


class RollingLevel(_OnFriction):
    """Rolling friction is not the nominal one."""

    name = "rolling_level"
    title = "rolling friction"
    physics = "The lubricant between rolling parts opposes motion with (1 + x) r |v|^(2/3) on the motor side."
    source = f"{PALMGREN}; range: as of viscous friction, assumed"
    parameters = (Parameter("change", "", 0.0, 0.1, 0.8, "of rolling friction, relative", signed=True, least=-1.0),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return with_rolling(compiled)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]
        return (lambda spec, robot: scale_rolling(spec, drive_of(robot, place), 1 + change)) if change else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return _rolls(place, followed, values["change"] * float(followed.compiled.motor_rolling[place.index]))


class RollingFriction(_WithCoulomb):
    """Friction of lubricated rolling contacts, which grows less than in proportion to speed.

    It bends friction over speed that is there, and needs some of both kinds: one number in the place of a small Coulomb
    and a viscous part would be the simpler model, and wrong.
    """

    name = "rolling_friction"
    title = "rolling friction of lubricated bearings and gears"
    physics = (
        "Rolling parts that press through their lubricant rub with r |v|^(2/3), v in rad/s (m/s): friction bends over "
        "speed, where shear alone (viscous friction) makes it straight. It is put on the motor side."
    )
    source = f"{PALMGREN}; range: 0.2 to 20 % of the torque limit, assumed"
    is_additive = True
    parameters = (
        Parameter("rolling", "Nm", 0.0, 20.0, 2000.0, "r, at 1 rad/s; range for a drive of 10 kNm", least=0.0),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives with Coulomb and with viscous friction, and none of this yet."""
        rich, coefficient = with_rolling(compiled), viscous(compiled)
        return tuple(p for p in super().places(compiled) if coefficient[p.index] > 0 and p not in rich)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        more = values["rolling"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            give_side(spec, robot, drive, "motor", rolling=rolling(spec, drive) + more)

        return change if more else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return _rolls(place, followed, values["rolling"])


class FrictionTemperature(_OnFriction):
    """Friction falls as the gearbox warms up."""

    name = "friction_temperature"
    title = "friction falls with gear temperature"
    physics = (
        "A warm lubricant is thinner: Coulomb, viscous and rolling friction of the drive become "
        "exp(-c (T_gear - 293.15 K)) of their nominal values."
    )
    source = f"{BITTENCOURT} (friction over temperature); range: DESIGN 6, 0.01 to 0.04 /K"
    parameters = (Parameter("decrease", "1/K", 0.0, 0.01, 0.04, "c, relative decrease per kelvin"),)
    needs = ("gear_temperature",)
    depends_on_conditions = True

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        rich = {place.index for place in (*with_coulomb(compiled), *with_rolling(compiled))}
        coefficient = viscous(compiled)
        return tuple(place for place in drives(compiled) if place.index in rich or coefficient[place.index] > 0)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        factor = exp(-values["decrease"] * float(conditions.gear_k[place.index] - REFERENCE_K))

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            scale_coulomb(spec, drive, factor)
            scale_viscous(spec, drive.rotor, factor)
            scale_rolling(spec, drive, factor)

        return change if factor != 1 else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        share = np.expm1(-values["decrease"] * (followed.gear_k[:, place.index] - REFERENCE_K))
        coulomb = scaled_friction(place, followed, share, share)
        drag = _drag(place, followed, float(viscous(followed.compiled)[place.index]))
        return Torques(coulomb.motor + share * drag.motor, coulomb.link) if coulomb else None


class FrictionSide(_WithCoulomb):
    """Friction sits on the other side of the elastic element than the model has it."""

    name = "friction_side"
    title = "friction between motor side and link side"
    physics = (
        "What sits before the elastic element is paid by the motor alone; what sits behind it (output bearing, seals) "
        "carries part of the load. x > 0 moves x of the motor side's level to the link side, x < 0 moves -x of "
        "the link "
        "side's to the motor side; the sum stays."
    )
    source = "DESIGN 3 (both sides and what they do to identification); range: all of it may move"
    parameters = (
        Parameter(
            "moved", "", 0.0, 0.1, 1.0, "share that moves, + to the link side", signed=True, least=-1.0, most=1.0
        ),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        moved = values["moved"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            motor, link = coulomb(spec, drive, "motor"), coulomb(spec, drive, "link")
            step = moved * (motor if moved > 0 else link)
            set_coulomb(spec, drive, "motor", motor - step)
            set_coulomb(spec, drive, "link", link + step)

        return change if moved else None


def scaled_friction(place: Place, followed: Followed, motor: Array | float, link: Array | float) -> Torques | None:
    """Return what Coulomb friction adds whose levels grow by some shares, each a number or of shape (T,)."""
    on_motor = sliding_friction(followed, "motor", place.index)
    on_link = sliding_friction(followed, "link", place.index)
    if on_motor is None or on_link is None:
        return None
    return Torques(motor * on_motor, link * on_link)


def _drag(place: Place, followed: Followed, coefficient: float) -> Torques:
    return Torques(motor=-coefficient * followed.trace.q_velocity[:, place.index])


def _rolls(place: Place, followed: Followed, rolling: float) -> Torques:
    speed = followed.trace.q_velocity[:, place.index]
    return Torques(motor=-rolling * np.sign(speed) * np.abs(speed) ** ROLLING_POWER)


def with_coulomb(compiled: CompiledRobot) -> tuple[Place, ...]:
    """Return the drives with Coulomb friction on at least one side."""
    level = compiled.motor_coulomb + compiled.link_coulomb
    return tuple(place for place in drives(compiled) if level[place.index] > 0)


def with_rolling(compiled: CompiledRobot) -> tuple[Place, ...]:
    """Return the drives with rolling friction on the motor side."""
    return tuple(place for place in drives(compiled) if compiled.motor_rolling[place.index] > 0)


def scale_viscous(spec: mujoco.MjSpec, rotor: str, factor: float) -> None:
    """Multiply the damping of a rotor's joint."""
    joint = spec.joint(rotor)
    joint.damping = factor * np.asarray(joint.damping)


def viscous(compiled: CompiledRobot) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the viscous coefficients of the drives, shape (n,) [Nm s/rad]."""
    return np.asarray(compiled.model.dof_damping[compiled.at.q_dof], dtype=np.float64)
