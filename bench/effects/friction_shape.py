"""Friction of a drive: how its level depends on speed, load, direction and angle."""

from collections.abc import Mapping
from dataclasses import replace
from math import atan2, hypot, pi

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.friction import ARMSTRONG, BITTENCOURT, WithCoulomb, scaled_friction
from bench.effects.friction_elements import SIDES, give, give_side, given, rolling
from bench.effects.lubricant import viscous
from bench.effects.places import OnDrive, drive_of
from bench.robot.compiled import CompiledRobot, SpecEdit, read_spec
from bench.robot.folder import Robot


class Stribeck(WithCoulomb):
    """More friction at standstill than in motion."""

    name = "stribeck"
    title = "Stribeck effect"
    physics = (
        "At low speed no lubricant film carries: the level rises to f_C (1 + r exp(-(v/v_s)^2)), on both sides of the "
        "elastic element."
    )
    motion = "sweeps of these joints at several slow steady speeds"
    source = (
        f"{ARMSTRONG}; Bona and Indri, Friction compensation in robotics: an overview, 2005; "
        "range: design of this project"
    )
    parameters = (
        Parameter("rise", "", 0.0, 0.1, 0.5, "r, rise at standstill, relative"),
        Parameter("speed", "rad/s", 0.02, 0.003, 0.1, "v_s, at which the rise has fallen to 1/e", is_shape=True),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        rise, speed = values["rise"], values["speed"]
        if not rise:
            return None

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            for side in SIDES:
                more = rise + given(spec, drive, side, "static_rise")
                give_side(spec, robot, drive, side, stribeck_velocity=speed, static_rise=more)

        return change

    def there_already(self, compiled: CompiledRobot, place: Place) -> Mapping[str, float]:
        """Return the rise that a model has already."""
        spec, drive = read_spec(compiled.robot), drive_of(compiled.robot, place)
        return {"rise": max(given(spec, drive, side, "static_rise") for side in SIDES)}


class LoadFriction(OnDrive):
    """Friction grows with the torque that the gear transmits."""

    name = "load_friction"
    family = "drive friction"
    title = "friction grows with the transmitted torque"
    physics = (
        "Tooth and pin contacts are pressed by the load: the motor-side level rises by mu |tau|, tau of the elastic"
        " element."
    )
    source = f"{BITTENCOURT} (load torque); range: design of this project, 0.01 to 0.06 of the torque"
    parameters = (Parameter("coefficient", "", 0.0, 0.01, 0.06, "mu, level per transmitted torque"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        coefficient = values["coefficient"]
        if not coefficient:
            return None

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            more = coefficient + given(spec, drive, "motor", "load_coefficient")
            give_side(spec, robot, drive, "motor", element=drive.element, load_coefficient=more)

        return change

    def there_already(self, compiled: CompiledRobot, place: Place) -> Mapping[str, float]:
        """Return the coefficient that a model has already."""
        drive = drive_of(compiled.robot, place)
        return {"coefficient": given(read_spec(compiled.robot), drive, "motor", "load_coefficient")}


class DirectionFriction(WithCoulomb):
    """Friction differs between the directions."""

    name = "direction_friction"
    title = "friction depends on the direction"
    physics = (
        "Worn or preloaded flanks rub unequally: the level is f_C (1 + d) in motion towards +, f_C (1 - d) towards -."
    )
    source = f"{ARMSTRONG} (asymmetric friction); range: assumed"
    parameters = (
        Parameter(
            "asymmetry", "", 0.0, 0.05, 0.4, "d, surplus towards +, relative", signed=True, least=-0.95, most=0.95
        ),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        asymmetry = values["asymmetry"]
        if not asymmetry:
            return None

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            for side in SIDES:
                more = asymmetry + given(spec, drive, side, "asymmetry")
                give_side(spec, robot, drive, side, asymmetry=more)

        return change

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        plain = scaled_friction(place, followed, 1.0, 1.0)
        if plain is None:
            return None
        return Torques(-values["asymmetry"] * np.abs(plain.motor), -values["asymmetry"] * np.abs(plain.link))


class DirectionViscous(WithCoulomb):
    """Friction of the lubricant, viscous and rolling, differs between the directions."""

    name = "direction_viscous"
    title = "friction over speed depends on the direction"
    physics = (
        "Gears, seals and screws pump their lubricant better one way: viscous and rolling friction are 1 + d times "
        "f_v v + r v^(2/3) in motion towards +, 1 - d times towards -. It is put on the motor side."
    )
    source = f"{ARMSTRONG} (asymmetric friction); range: assumed"
    parameters = (
        Parameter(
            "asymmetry", "", 0.0, 0.05, 0.4, "d, surplus towards +, relative", signed=True, least=-0.95, most=0.95
        ),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        lubricated = viscous(compiled) + compiled.motor_rolling
        return tuple(place for place in super().places(compiled) if lubricated[place.index] > 0)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        asymmetry = values["asymmetry"]
        if not asymmetry:
            return None

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            if coefficient := float(np.ravel(spec.joint(drive.rotor).damping)[0]):
                more = asymmetry * coefficient + given(spec, drive, "motor", "viscous_asymmetry")
                give_side(spec, robot, drive, "motor", viscous_asymmetry=more)
            if rolling(spec, drive):
                more = asymmetry + given(spec, drive, "motor", "rolling_asymmetry")
                give_side(spec, robot, drive, "motor", rolling_asymmetry=more)

        return change


class FrictionRipple(WithCoulomb):
    """The level of friction varies over the joint's angle."""

    name = "friction_ripple"
    title = "friction depends on the angle"
    physics = (
        "Eccentric bearings and gears press unequally over a turn: the level is "
        "f_C (1 + s sin(2 pi x/p) + c cos(2 pi x/p)) at the angle x."
    )
    source = "Armstrong-Helouvry, Control of machines with friction, 1991 (position-dependent friction); range: assumed"
    parameters = (
        Parameter("sin", "", 0.0, 0.05, 0.4, "s, relative", signed=True),
        Parameter("cos", "", 0.0, 0.05, 0.4, "c, relative", signed=True),
        Parameter("period", "rad", pi / 3, pi / 40, 2 * pi, "p", is_shape=True, ratio=1.2),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives that have Coulomb friction without a ripple; an element has room for one."""
        spec, drives = read_spec(compiled.robot), compiled.robot.figures.drives
        return tuple(
            place
            for place in super().places(compiled)
            if not any(given(spec, drives[place.index], side, "ripple") for side in SIDES)
        )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        sine, cosine = values["sin"], values["cos"]
        if not (sine or cosine):
            return None
        return lambda spec, robot: give(
            spec,
            robot,
            drive_of(robot, place),
            ripple_period=values["period"],
            ripple=hypot(sine, cosine),
            ripple_phase=atan2(cosine, sine),
        )

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return scaled_friction(place, followed, *_shares(place, values, followed))

    def averaged(self, place: Place, values: Values, followed: Followed) -> Torques:
        j, trace = place.index, followed.trace
        middle = _shares(place, values, replace(followed, waves=None))
        more = [
            (1 + mean) / (1 + there) - 1 for mean, there in zip(_shares(place, values, followed), middle, strict=True)
        ]
        return Torques(more[0] * trace.motor_friction[:, j], more[1] * trace.link_friction[:, j])


def _shares(place: Place, values: Values, followed: Followed) -> tuple[Array, Array]:
    """Return by which shares the levels of motor and link are higher, shape (T,) each."""
    period, j = values["period"], place.index
    at_motor = (values["cos"] - 1j * values["sin"]) * followed.wave(period, j)
    given = np.exp(2j * pi / period * (followed.trace.theta[:, j] - followed.trace.q[:, j]))
    return np.real(at_motor), np.real(at_motor * given)
