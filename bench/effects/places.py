"""Where effects can act, and what is plausible there."""

from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.effect import Effect, Parameter, Place
from bench.effects.nominal import moving_bodies
from bench.robot.compiled import CompiledRobot
from bench.robot.figures import Drive
from bench.robot.folder import Robot
from bench.robot.plugins import PREFIX
from bench.robot.starter.defaults import ROTOR_GUESSED

SHORT = 0.1  # assumed: [m]; a link shorter than this has no length to speak of, and does not bend
HEAVY_TORQUE = 10e3  # declared: [Nm]; ranges in Nm are stated for a drive of this torque limit ...
HEAVY_SPEED = 2.0  # declared: [rad/s]; ... and this speed limit, and scaled to each drive
GUESSED = 1 + ROTOR_GUESSED  # derived: of a limit that `bench new-robot` made up, as well known as rotors guessed by it

_POWERS_OF_SPEED = {"Nm s/rad": 1, "Nm s^2/rad^2": 2}


class OnDrive(Effect):
    """An effect that acts on one drive; its ranges scale with the drive's limits.

    A parameter in Nm, Nm/rad or Nm s/rad is as plausible on a light drive as on a heavy one at the same share of its
    torque limit and speed limit. A slide has N for Nm and m for rad.
    """

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives on which it may act: all, unless a subclass picks."""
        return drives(compiled)

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameters with ranges and units of a drive."""
        limit, speed = most_torque(compiled, place.index), least_speed(compiled, place.index)
        slides = compiled.model.jnt_type[compiled.at.joint[place.index]] == mujoco.mjtJoint.mjJNT_SLIDE
        return tuple(_scaled(parameter, limit, speed, bool(slides)) for parameter in self.parameters)


def drives(compiled: CompiledRobot) -> tuple[Place, ...]:
    """Return all drives."""
    return tuple(Place("joint", i, drive.joint) for i, drive in enumerate(compiled.robot.figures.drives))


def hinges(compiled: CompiledRobot) -> tuple[Place, ...]:
    """Return the drives that turn a hinge."""
    kinds = compiled.model.jnt_type[compiled.at.joint]
    return tuple(place for place in drives(compiled) if kinds[place.index] == mujoco.mjtJoint.mjJNT_HINGE)


def links(compiled: CompiledRobot) -> tuple[Place, ...]:
    """Return the moving bodies that have a mass, without the one that carries the payload and those of effects."""
    bodies = [compiled.model.body(name) for name in moving_bodies(compiled)]
    return tuple(
        Place("body", int(body.id), str(body.name))
        for body in bodies
        if body.mass[0] > 0 and body.id != compiled.at.load_body and not body.name.startswith(PREFIX)
    )


def drive_of(robot: Robot, place: Place) -> Drive:
    """Return the drive at a place."""
    return robot.figures.drives[place.index]


def torque_limit(compiled: CompiledRobot, index: int) -> float:
    """Return the greatest torque of a drive [Nm], of a slide the force [N]; of an unlimited servo a guess."""
    model, servo = compiled.model, compiled.at.servo[index]
    if model.actuator_forcelimited[servo]:
        return float(np.max(np.abs(model.actuator_forcerange[servo])))
    return compiled.robot.figures.rating.force_n  # at an arm of 1 m


def most_torque(compiled: CompiledRobot, index: int) -> float:
    """Return how great the torque limit of a drive may be [Nm], [N]: as stated, or as far as a guess may be off."""
    figures = compiled.robot.figures
    is_guess = figures.assumes("torque limit", figures.drives[index].joint)
    return torque_limit(compiled, index) * (GUESSED if is_guess else 1.0)


def speed_limit(compiled: CompiledRobot, index: int) -> float:
    """Return the greatest speed of a drive [rad/s] (of a slide [m/s])."""
    return compiled.robot.figures.drives[index].speed_limit_rad_per_s


def most_speed(compiled: CompiledRobot, index: int) -> float:
    """Return how high the speed limit of a drive may be [rad/s], [m/s]: as stated, or as far as a guess may be off."""
    return speed_limit(compiled, index) ** 2 / least_speed(compiled, index)


def most_acceleration(compiled: CompiledRobot, index: int) -> float:
    """Return what the torque limit of a drive gives its rotor alone [rad/s^2], [m/s^2]; inf where either is a guess."""
    drive = compiled.robot.figures.drives[index]
    if any(compiled.robot.figures.assumes(figure, drive.joint) for figure in ("torque limit", "rotor inertia")):
        return np.inf
    rotor = float(compiled.model.dof_armature[compiled.at.q_dof[index]])
    return torque_limit(compiled, index) / rotor if rotor > 0 else np.inf


def least_speed(compiled: CompiledRobot, index: int) -> float:
    """Return how low the speed limit of a drive may be [rad/s], [m/s]: as stated, or as far as a guess may be off."""
    figures = compiled.robot.figures
    is_guess = figures.assumes("speed limit", figures.drives[index].joint)
    return speed_limit(compiled, index) / (GUESSED if is_guess else 1.0)


def _scaled(parameter: Parameter, limit: float, speed: float, slides: bool) -> Parameter:
    unit, words = parameter.unit, parameter.words
    scale = 1.0
    if "Nm" in unit:
        scale = HEAVY_TORQUE / limit if unit.endswith("/Nm") else limit / HEAVY_TORQUE
    if unit in _POWERS_OF_SPEED:
        scale *= (HEAVY_SPEED / speed) ** _POWERS_OF_SPEED[unit]
    if slides:
        unit, words = unit.replace("Nm", "N").replace("rad", "m"), words.replace("at 1 rad/s", "at 1 m/s")
    if parameter.is_shape:  # keeps the value that is assumed first within the range
        return replace(parameter, unit=unit, words=words)
    return replace(parameter, unit=unit, words=words, low=scale * parameter.low, high=scale * parameter.high)
