"""What tracker and force sensor say that is not so."""

from dataclasses import replace

import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Array, Effect, Parameter, Place, Values
from bench.record.units import HOUR
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading, is_slanting, small_rotation
from bench.simulate.trace import Trace


class _OfTracker(Effect):
    family = "sensing"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return (WHOLE,) if compiled.robot.figures.instruments.tracker else ()


class TrackerFrame(_OfTracker):
    """The tracker's frame is not the robot's."""

    name = "tracker_frame"
    title = "frame of the laser tracker"
    between = "anew"
    physics = "Base frame and tracker frame were aligned with an error: readings are R(r) p + t."
    source = "Nubiola and Bonev, 2013; range: design of this project, 0.05 to 0.5 mm and 0.01 to 0.05 deg"
    parameters = (
        *(Parameter(f"t{axis}", "m", 0.0, 5e-5, 5e-4, f"shift along {axis}", signed=True) for axis in "xyz"),
        *(Parameter(f"r{axis}", "rad", 0.0, 1.7e-4, 8.7e-4, f"turn about {axis}", signed=True) for axis in "xyz"),
    )

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        turn = small_rotation(vector_of(values, "r"))
        return replace(reading, reflectors=reading.reflectors @ turn.T + vector_of(values, "t"))


class TrackerDrift(_OfTracker):
    """The tracker, or what it stands on, creeps."""

    name = "tracker_drift"
    title = "drift of the laser tracker"
    between = "anew"
    physics = "Tripod, floor and air warm up: readings move by rate x time since the start of the campaign."
    source = "ISO 10360-10, laser trackers; range: design of this project, 5 to 50 um/h"
    parameters = tuple(Parameter(axis, "m/h", 0.0, 5e-6, 5e-5, f"rate along {axis}", signed=True) for axis in "xyz")

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        drift = trace.time[:, None, None] / HOUR * vector_of(values, "")
        return replace(reading, reflectors=reading.reflectors + drift)


class TrackerScale(_OfTracker):
    """The tracker's weather station is wrong."""

    name = "tracker_scale"
    title = "scale of the laser tracker"
    between = "anew"
    physics = (
        "With a wrong refractive index all distances read (1 + s) of the truth; taken about the origin of the base, the"
        " rest is a shift."
    )
    source = "Ciddor, Refractive index of air, 1996: 1 ppm/K, 0.27 ppm/hPa; range: assumed"
    parameters = (Parameter("scale", "", 0.0, 3e-5, 5e-4, "s", signed=True),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return replace(reading, reflectors=(1 + values["scale"]) * reading.reflectors)


class _OfForce(Effect):
    family = "sensing"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return (WHOLE,) if compiled.robot.figures.instruments.force else ()


class ForceGain(_OfForce):
    """The force sensor shows too much or too little."""

    name = "force_gain"
    title = "gain of the force sensor"
    physics = "Force and moment read (1 + x) of the truth."
    source = "ISO 376, force-proving instruments (classes); range: design of this project, 0.5 to 3 %"
    parameters = (Parameter("gain", "", 0.0, 5e-3, 3e-2, "x, relative", signed=True),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        factor = 1 + values["gain"]
        return replace(reading, force=factor * reading.force, moment=factor * reading.moment)


class ForceTilt(_OfForce):
    """The force sensor is mounted askew."""

    name = "force_tilt"
    title = "tilt of the force sensor"
    between = "anew"
    physics = (
        "The sensor's axes are turned against the world's: it reads R(r) F. A hanging load counts as vertical and "
        "is not turned."
    )
    source = "range: design of this project, 0.5 to 3 % of the force sideways (0.3 to 1.7 deg); form assumed"
    parameters = tuple(Parameter(axis, "rad", 0.0, 5e-3, 3e-2, f"rotation about {axis}", signed=True) for axis in "xyz")

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        turn = small_rotation(vector_of(values, ""))
        force = trace.wrench[:, :3]
        slants = is_slanting(force)
        return replace(
            reading,
            force=np.where(slants, reading.force @ turn.T, reading.force),
            moment=np.where(slants, reading.moment @ turn.T, reading.moment),
        )


def vector_of(values: Values, prefix: str) -> Array:
    """Return the values whose names are a prefix and an axis, shape (3,)."""
    return np.array([values[prefix + axis] for axis in "xyz"])
