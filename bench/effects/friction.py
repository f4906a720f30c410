"""Friction of a drive: how high its levels are, and on which side of the elastic element it sits."""

from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.friction_elements import coulomb, scale_coulomb, set_coulomb
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
# Wear, preload and lubricant act on all friction of a drive (Bittencourt and Gunnarsson, 2012)
ALL_OF_A_DRIVE = ("coulomb_level", "viscous_level", "rolling_level", "stribeck", "load_friction")

DIGITS = 3  # rounding: of the share of friction that sits on a side, in ranges


class OnFriction(OnDrive):
    """Of the friction of a drive."""

    family = "drive friction"


class WithCoulomb(OnFriction):
    """It changes Coulomb friction that is there, so it needs some."""

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return with_coulomb(compiled)


class CoulombLevel(WithCoulomb):
    """The level of sliding friction is not the nominal one."""

    name = "coulomb_level"
    title = "Coulomb level"
    physics = "Preload, wear and lubricant set the level of dry friction: both sides' levels become (1 + x) f_C."
    source = f"{BITTENCOURT}; range: spread between units and over life, assumed"
    parameters = (Parameter("change", "", 0.0, 0.1, 0.6, "of the level, relative", signed=True, least=-1.0),)
    moves_with = ALL_OF_A_DRIVE

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]
        return (lambda spec, robot: scale_coulomb(spec, drive_of(robot, place), 1 + change)) if change else None

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return scaled_friction(place, followed, values["change"], values["change"])


class CoulombFriction(OnFriction):
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


class FrictionSide(WithCoulomb):
    """Friction sits on the other side of the elastic element than the model has it."""

    name = "friction_side"
    title = "friction between motor side and link side"
    physics = (
        "What sits before the elastic element is paid by the motor alone; what sits behind it (output bearing, seals) "
        "carries part of the load. x of the sum of both sides' levels moves to the link side, where x < 0 from there; "
        "the sum stays."
    )
    source = "design of this project (both sides and what they do to identification); range: all of a side may move"
    parameters = (
        Parameter(
            "moved",
            "",
            0.0,
            0.1,
            1.0,
            "share of both sides' sum that moves, + to the link side",
            signed=True,
            least=-1.0,
            most=1.0,
        ),
    )

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the share with its range: no more than a side has; a typical one moves to the link side.

        Where the motor has no friction in the file, nobody knows what it has, and all may be on either side.
        """
        (moved,) = self.parameters
        levels = np.array([compiled.motor_coulomb[place.index], compiled.link_coulomb[place.index]])
        if not levels[0] > 0:
            return (moved,)
        motor, link = np.round(levels / np.sum(levels), DIGITS).tolist()
        high = max(motor, link)  # and `low` such that a typical move is as large a share of the motor's as of all above
        return (replace(moved, low=moved.low * motor**2 / high, high=high, least=-link, most=motor),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        moved = values["moved"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            motor, link = coulomb(spec, drive, "motor"), coulomb(spec, drive, "link")
            step = float(np.clip(moved * (motor + link), -link, motor))
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


def with_coulomb(compiled: CompiledRobot) -> tuple[Place, ...]:
    """Return the drives with Coulomb friction on at least one side."""
    level = compiled.motor_coulomb + compiled.link_coulomb
    return tuple(place for place in drives(compiled) if level[place.index] > 0)
