"""Friction that its lubricant makes: it grows with speed, in proportion or less, and falls with temperature."""

from abc import abstractmethod
from collections.abc import Hashable
from dataclasses import replace

import mujoco
import numpy as np

from bench.actuators.laws import ROLLING_POWER
from bench.effects.conditions import REFERENCE_K, Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.friction import (
    ALL_OF_A_DRIVE,
    ARMSTRONG,
    BITTENCOURT,
    OnFriction,
    WithCoulomb,
    scaled_friction,
    with_coulomb,
)
from bench.effects.friction_elements import give_side, rolling, scale_coulomb, scale_rolling
from bench.effects.places import drive_of, drives
from bench.effects.recorded import Recorded
from bench.record.moving import FEWEST_TIMES, TIME_STEP_S
from bench.record.units import HOUR
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

PALMGREN = "Palmgren, Ball and roller bearing engineering, 1959: M_0 ~ (nu n)^(2/3) (the SKF model has the power 0.6)"


class Viscous(OnFriction):
    """The viscous coefficient is not the nominal one."""

    name = "viscous_level"
    title = "viscous friction"
    physics = "Shear of the lubricant opposes motion in proportion to speed, f = (1 + x) f_v v on the motor side."
    source = f"{BITTENCOURT}; range: lubricant and filling, assumed"
    parameters = (Parameter("change", "", 0.0, 0.1, 0.8, "of the coefficient, relative", signed=True, least=-1.0),)
    moves_with = ALL_OF_A_DRIVE

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return tuple(place for place in drives(compiled) if viscous(compiled)[place.index] > 0)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]
        return (lambda spec, robot: scale_viscous(spec, drive_of(robot, place).rotor, 1 + change)) if change else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return _drag(place, followed, values["change"] * float(viscous(followed.compiled)[place.index]))


class ViscousFriction(OnFriction):
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


class RollingLevel(OnFriction):
    """Rolling friction is not the nominal one."""

    name = "rolling_level"
    title = "rolling friction"
    physics = "The lubricant between rolling parts opposes motion with (1 + x) r |v|^(2/3) on the motor side."
    source = f"{PALMGREN}; range: as of viscous friction, assumed"
    parameters = (Parameter("change", "", 0.0, 0.1, 0.8, "of rolling friction, relative", signed=True, least=-1.0),)
    moves_with = ALL_OF_A_DRIVE

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return with_rolling(compiled)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]
        return (lambda spec, robot: scale_rolling(spec, drive_of(robot, place), 1 + change)) if change else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return _rolls(place, followed, values["change"] * float(followed.compiled.motor_rolling[place.index]))


class RollingFriction(WithCoulomb):
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
    source = (
        f"{PALMGREN}; range: 0.2 to 20 % of the torque limit, assumed, but no more than the Coulomb and viscous "
        "friction that the file states, at 1 rad/s"
    )
    is_additive = True
    parameters = (
        Parameter("rolling", "Nm", 0.0, 20.0, 2000.0, "r, at 1 rad/s; range for a drive of 10 kNm", least=0.0),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives with Coulomb and with viscous friction, and none of this yet."""
        rich, coefficient = with_rolling(compiled), viscous(compiled)
        return tuple(p for p in super().places(compiled) if coefficient[p.index] > 0 and p not in rich)

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the size with its range: it bends friction that is stated, and is not many times as large."""
        (rolling,) = super().parameters_at(compiled, place)
        coulomb = float(compiled.motor_coulomb[place.index] + compiled.link_coulomb[place.index])
        sheared = float(viscous(compiled)[place.index])
        stated = coulomb + sheared
        if not (coulomb and sheared and stated < rolling.high):
            return (rolling,)
        return (replace(rolling, low=rolling.low * stated / rolling.high, high=stated),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        more = values["rolling"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            give_side(spec, robot, drive, "motor", rolling=rolling(spec, drive) + more)

        return change if more else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return _rolls(place, followed, values["rolling"])


class _Falling(OnFriction):
    """All friction of a drive is a share of what the model says, another one at other times of a campaign."""

    @abstractmethod
    def _rise(self, place: Place, values: Values, gear_k: Array, since_start: Array) -> Array:
        """Return the logarithm of that share, shape (T,).

        Args:
            place: A drive.
            values: Parameters.
            gear_k: Shape (T,) [K], of its gearbox.
            since_start: Shape (T,) [s], from the start of the campaign.
        """

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        rich = {place.index for place in (*with_coulomb(compiled), *with_rolling(compiled))}
        coefficient = viscous(compiled)
        return tuple(place for place in drives(compiled) if place.index in rich or coefficient[place.index] > 0)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        now = np.array([conditions.gear_k[place.index]]), np.array([conditions.time_s])
        factor = float(np.exp(self._rise(place, values, *now)[0]))

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            scale_coulomb(spec, drive, factor)
            scale_viscous(spec, drive.rotor, factor)
            scale_rolling(spec, drive, factor)

        return change if factor != 1 else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        share = np.expm1(self._rise(place, values, followed.gear_k[:, place.index], followed.since_start))
        coulomb = scaled_friction(place, followed, share, share)
        viscous_part = _drag(place, followed, float(viscous(followed.compiled)[place.index]))
        return Torques(coulomb.motor + share * viscous_part.motor, coulomb.link) if coulomb else None


class FrictionTemperature(_Falling):
    """Friction falls as the gearbox warms up."""

    name = "friction_temperature"
    title = "friction falls with gear temperature"
    physics = (
        "A warm lubricant is thinner: Coulomb, viscous and rolling friction of the drive become "
        "exp(-c (T_gear - 293.15 K)) of their nominal values."
    )
    source = f"{BITTENCOURT} (friction over temperature); range: design of this project, 0.01 to 0.04 /K"
    parameters = (Parameter("decrease", "1/K", 0.0, 0.01, 0.04, "c, relative decrease per kelvin"),)
    needs = ("gear_temperature",)
    depends_on_conditions = True

    def _rise(self, place: Place, values: Values, gear_k: Array, since_start: Array) -> Array:
        return -values["decrease"] * (gear_k - REFERENCE_K)


class FrictionWarming(_Falling):
    """Friction falls as the drive warms up, and no thermometer shows it."""

    name = "friction_warming"
    level = "run"
    title = "friction that falls during the session"
    physics = (
        "A drive warms up as it works, and its lubricant becomes thinner: Coulomb, viscous and rolling friction are "
        "exp(-r (t - t_m)) of what they are in the middle t_m of its motion. Where gear temperatures are recorded, "
        "friction_temperature is looked for in its place."
    )
    source = f"{BITTENCOURT} (friction over temperature); range: 10 to 60 % in an hour, either way, assumed"
    advice = (
        "warm up for half an hour before you record, or record the temperatures of the gears; the rate is by the "
        "`start_s` of the runs in campaign.yaml"
    )
    parameters = (Parameter("rate", "1/h", 0.0, 0.1, 1.0, "r, relative decrease per hour", signed=True),)

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return the drives that move at three different times at least: two tell that they differ, not since when."""
        if any(name.startswith("gear_temperature") for name in recorded.columns):
            return ()
        found = []
        for place in self.places(compiled):
            runs = [run for run in recorded.runs if place.index in run.moving]
            if len({k for run in runs for k in range(_step(run.start_s), _step(run.end_s) + 1)}) >= FEWEST_TIMES:
                found.append(replace(place, about_s=(runs[0].start_s + runs[-1].end_s) / 2))
        return tuple(found)

    def phase(self, place: Place, conditions: Conditions) -> Hashable:
        """Return the step of time."""
        return _step(conditions.time_s)

    def _rise(self, place: Place, values: Values, gear_k: Array, since_start: Array) -> Array:
        return -values["rate"] * (TIME_STEP_S * np.round(since_start / TIME_STEP_S) - place.about_s) / HOUR


def _step(time_s: float) -> int:
    """Return the step of time in which friction is one level."""
    return round(time_s / TIME_STEP_S)


def _drag(place: Place, followed: Followed, coefficient: float) -> Torques:
    return Torques(motor=-coefficient * followed.trace.q_velocity[:, place.index])


def _rolls(place: Place, followed: Followed, rolling: float) -> Torques:
    speed = followed.trace.q_velocity[:, place.index]
    return Torques(motor=-rolling * np.sign(speed) * np.abs(speed) ** ROLLING_POWER)


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
