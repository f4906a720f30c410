"""What currents and encoders say that is not so."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bench.effects.conditions import REFERENCE_K, Conditions
from bench.effects.effect import WHOLE, Array, Effect, Parameter, Place, Values
from bench.effects.places import OnDrive, drives, hinges, torque_limit
from bench.effects.recorded import LATEST_DRIVE_S, Lateness
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace

GUTT = "Bittencourt and Gunnarsson, 2012; Swevers, Verdonck and De Schutter, 2007 (torque from current)"
HEAVY_CURRENT = (
    50.0  # declared: [A]; ranges per A^2 are stated for a drive that reaches its torque limit with this current
)


class _OnCurrent(OnDrive):
    family = "sensing"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        fitted = compiled.robot.figures.instruments
        return drives(compiled) if fitted.current or fitted.torque else ()


class TorqueConstant(_OnCurrent):
    """The torque constant is not the data sheet's."""

    name = "torque_constant"
    title = "torque constant"
    physics = "The motor makes (1 + x) xi of torque per ampere, so the same torque shows as a current of 1/(1 + x)."
    source = (
        "Corke, In situ measurement of robot motor electrical constants, 1996; range: design of this project, 2 to 10 %"
    )
    parameters = (Parameter("change", "", 0.0, 0.02, 0.1, "of xi, relative", signed=True),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return _currents(reading, place, lambda seen: seen / (1 + values["change"]))


class TorqueSaturation(_OnCurrent):
    """The iron saturates at high current."""

    name = "torque_saturation"
    title = "saturation of the torque constant"
    physics = (
        "Iron saturates, so xi falls with current, xi (1 - c I^2): torque tau needs the current I (1 + c I^2), I = "
        "tau/xi."
    )
    source = (
        "Krishnan, Permanent magnet synchronous and brushless DC motor drives, 2009; range: 2 to 20 % at the limit,"
        " assumed"
    )
    parameters = (
        Parameter("curvature", "1/A^2", 0.0, 8e-6, 8e-5, "c; range for a drive that takes 50 A at its torque limit"),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives whose current is read."""
        return drives(compiled) if compiled.robot.figures.instruments.current else ()

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameters with the range of a drive."""
        current = torque_limit(compiled, place.index) / compiled.torque_constant[place.index]
        scale = float(HEAVY_CURRENT / current) ** 2
        (curvature,) = self.parameters
        return (replace(curvature, low=scale * curvature.low, high=scale * curvature.high),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        current = _changed(reading.current, place.index, lambda seen: seen * (1 + values["curvature"] * seen**2))
        return replace(reading, current=current)


class TorqueConstantTemperature(_OnCurrent):
    """The magnets weaken as the motor warms up."""

    name = "torque_constant_temperature"
    title = "torque constant falls with motor temperature"
    physics = (
        "Remanence falls as the motor warms up, xi (1 - c (T_winding - 293.15 K)): the same torque takes more current."
    )
    source = "data sheets of NdFeB magnets, -0.09 to -0.12 %/K, of ferrite -0.2 %/K; range: design of this project"
    parameters = (Parameter("decrease", "1/K", 0.0, 5e-4, 2e-3, "c, relative decrease per kelvin"),)
    needs = ("motor_temperature",)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        factor = 1 - values["decrease"] * float(conditions.winding_k[place.index] - REFERENCE_K)
        return _currents(reading, place, lambda seen: seen / factor)


class CurrentOffset(_OnCurrent):
    """The current sensor's zero is off."""

    name = "current_offset"
    title = "offset of a current sensor"
    between = "drifts"
    physics = "Hall sensor and amplifier are off zero: the drive reports I + x."
    source = (
        "data sheets of closed-loop Hall sensors (offset 0.1 to 0.5 % of range); "
        "range: design of this project, 0.02 to 0.3 A"
    )
    parameters = (Parameter("offset", "A", 0.0, 0.02, 0.3, "reading less truth", signed=True),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives whose current is read."""
        return drives(compiled) if compiled.robot.figures.instruments.current else ()

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        current = _changed(reading.current, place.index, lambda seen: seen + values["offset"])
        return replace(reading, current=current)


class DriveDelay(Effect):
    """What drives report is older, or newer, than the angles of its row."""

    name = "drive_delay"
    family = "sensing"
    title = "delay of the drives' torques"
    physics = (
        "One controller samples or filters the currents of all drives alike: a row shows the torques of d before its "
        "angles. It shows where torques change fast. A single channel that is late is an error of its recording "
        "(channel_delay)."
    )
    source = "Swevers, Verdonck and De Schutter, 2007 (synchronised sampling); range: five bus cycles of 4 ms, assumed"
    parameters = (
        Parameter("delay", "s", 0.0, 5e-4, LATEST_DRIVE_S, "d, of all drives, against the motor encoders", signed=True),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the robot if its drives report current or torque."""
        fitted = compiled.robot.figures.instruments
        return (WHOLE,) if fitted.current or fitted.torque else ()

    def lateness(self, place: Place, values: Values) -> Lateness | None:
        """Return that all torques are late, and by how much."""
        return Lateness("motor_torque", None, values["delay"]) if values["delay"] else None


class EncoderDelay(Effect):
    """Angles are older than their time stamp."""

    name = "encoder_delay"
    family = "sensing"
    title = "delay of the motor encoders"
    physics = "The angles of a row were sampled d before the rest of it: they read q - d dq/dt."
    source = "Swevers, Verdonck and De Schutter, 2007 (synchronised sampling); range: design of this project, 1 to 5 ms"
    parameters = (Parameter("delay", "s", 0.0, 1e-3, 5e-3, "d, of all encoders"),)

    def encoder_error(self, place: Place, values: Values, q: Array, velocity: Array) -> Array | None:
        return -values["delay"] * velocity if values["delay"] else None


class EncoderEccentricity(OnDrive):
    """An encoder disc runs out."""

    name = "encoder_eccentricity"
    family = "sensing"
    title = "eccentricity of an encoder"
    physics = (
        "A disc out of centre reads q + s sin q + c cos q: once per turn of the joint, if it sits there or resets "
        "there."
    )
    source = "manufacturers' notes on graduation and centring error of angle encoders; range: assumed"
    parameters = (
        Parameter("sin", "rad", 0.0, 2e-5, 5e-4, "s", signed=True),
        Parameter("cos", "rad", 0.0, 2e-5, 5e-4, "c", signed=True),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives that turn a hinge."""
        return hinges(compiled)

    def encoder_error(self, place: Place, values: Values, q: Array, velocity: Array) -> Array | None:
        sine, cosine = values["sin"], values["cos"]
        if not (sine or cosine):
            return None
        error = np.zeros_like(q)
        error[:, place.index] = sine * np.sin(q[:, place.index]) + cosine * np.cos(q[:, place.index])
        return error


def _changed(values: Array, drive: int, change: Callable[[Array], Array]) -> Array:
    changed = values.copy()
    changed[:, drive] = change(values[:, drive])
    return changed


def _currents(reading: Reading, place: Place, change: Callable[[Array], Array]) -> Reading:
    """Change the current of a drive, and the torque that it reports, which is xi times the current."""
    return replace(
        reading,
        current=_changed(reading.current, place.index, change),
        torque=_changed(reading.torque, place.index, change),
    )
