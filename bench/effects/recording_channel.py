"""Channels that do not show what their name says: late, scaled, off zero, drifting, or off zero from some run on.

Some of these look like a fault of the machine, and only their size tells them apart: torque constant and scale of a
current, offset of a Hall sensor and a zero that nobody set. Both are then candidates, with priors as wide as each is
plausible. A torque constant has a normal prior of width 10 %/sqrt(3): a factor of two lies seventeen of its standard
deviations out and is all but impossible for it, while a scale of up to three has it within one. A
deviation of 5 % has a density fourteen times higher under the torque constant, which foresees it more precisely.
"""

from dataclasses import replace

import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Parameter, Place, Values
from bench.effects.recorded import LATEST_DRIVE_S, LateField, Lateness, Recorded
from bench.effects.recording_places import (
    GAUGE,
    TRACKER,
    OfCampaign,
    changed,
    drive_channels,
    force_sensor,
    from_each_run,
    full_scale,
    gauge,
    sets_in,
    tracker,
)
from bench.effects.sensing_bench import vector_of
from bench.record.units import HOUR
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading, small_rotation
from bench.simulate.trace import Trace


class _OfRecording(OfCampaign):
    family = "recording"
    level = "recording"


class ChannelDelay(_OfRecording):
    """A channel has another clock than the encoders."""

    name = "channel_delay"
    title = "delay"
    physics = (
        "An instrument has another clock, or its telegram waits: a row shows what was d before the angles of the row. "
        "Where the arm moves, reflectors lag by speed times d, and currents show the torque of an earlier angle."
    )
    source = (
        "Swevers, Verdonck and De Schutter, 2007 (synchronised sampling); range: a tracker or gauge on its own clock "
        "up to 0.2 s, a drive up to five cycles of 4 ms, assumed"
    )
    advice = "compare the clocks: let one joint jerk, and see when each channel shows it"
    parameters = (Parameter("delay", "s", 0.0, 0.01, 0.2, "d, against the motor encoders", True),)

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return the tracker, the gauge and, of several drives, their channels; all of them are `drive_delay`'s."""
        drives = drive_channels(compiled, recorded)
        return (*tracker(compiled, recorded), *gauge(compiled, recorded), *(drives if len(drives) > 1 else ()))

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameter with the range of a channel."""
        (delay,) = self.parameters
        has_own_clock = place.name in (TRACKER.name, GAUGE.name)
        latest = delay.high if has_own_clock else LATEST_DRIVE_S
        return (replace(delay, low=delay.low * latest / delay.high, high=latest),)

    def lateness(self, place: Place, values: Values) -> Lateness | None:
        """Return what is late, and by how much."""
        known: dict[str, LateField] = {TRACKER.name: "reflectors", GAUGE.name: "gas_force"}
        field = known.get(place.name, "motor_torque")
        drive = place.index if field == "motor_torque" else None
        return Lateness(field, drive, values["delay"]) if values["delay"] else None


class ChannelScale(_OfRecording):
    """A channel is in another unit, halved by a wrong setting, or turned."""

    name = "channel_scale"
    title = "scale"
    physics = (
        "A wrong calibration or unit (peak for RMS, pounds, a sensor set to another range): the channel reads (1 + x) "
        "of the truth. x = 1 is twice too much, x = -0.5 half, x = -2 the wrong sign."
    )
    source = "range: 10 % up to a factor of three; below that it is a torque constant or a gain; assumed"
    advice = "look at the unit, the range and the calibration of this channel"
    parameters = (Parameter("scale", "", 0.0, 0.1, 2.0, "x, relative", signed=True),)

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return the drives' channels, the gauge and the force sensor."""
        return (*drive_channels(compiled, recorded), *gauge(compiled, recorded), *force_sensor(recorded))

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return changed(reading, place, lambda seen: seen * (1 + values["scale"]))


class _OfOneNumber(_OfRecording):
    """An error of a channel with one number, as large as a share of its full scale."""

    parameters: tuple[Parameter, ...]

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return the drives' channels and the gauge."""
        return (*drive_channels(compiled, recorded), *gauge(compiled, recorded))

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameter in the unit of a channel, with the range of its full scale."""
        (size,) = self.parameters
        most, unit = full_scale(compiled, place)
        return (replace(size, unit=unit + size.unit, low=size.low * most, high=size.high * most),)


class ChannelOffset(_OfOneNumber):
    """A channel's zero was never set."""

    name = "channel_offset"
    title = "offset"
    physics = "The zero was not set, or set under load: the channel reads x more than there is."
    source = "range: 2 to 20 % of full scale, beyond what data sheets allow a sensor; assumed"
    advice = "read this channel with nothing on it, and set its zero"
    parameters = (Parameter("offset", "", 0.0, 0.02, 0.2, "x, range as a share of full scale", signed=True),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return changed(reading, place, lambda seen: seen + values["offset"])


class ChannelDrift(_OfOneNumber):
    """A channel's zero wanders over the day."""

    name = "channel_drift"
    title = "drift"
    physics = "An amplifier warms up: the channel reads rate x time since the start of the campaign more than there is."
    source = "range: 1 to 20 % of full scale in an hour, far beyond a sensor that warms up; assumed"
    advice = "read this channel with nothing on it at the start and at the end of a session"
    parameters = (Parameter("rate", "/h", 0.0, 0.01, 0.2, "rate, range as a share of full scale", signed=True),)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return changed(reading, place, lambda seen: seen + values["rate"] * trace.time / HOUR)


class ChannelStep(_OfOneNumber):
    """A channel's zero jumps between two runs."""

    name = "channel_step"
    title = "jump of the zero"
    physics = "A plug, a restart or a new zero between two runs: from then on the channel reads x more than there is."
    source = "range: 1 to 20 % of full scale, as of an offset; assumed"
    advice = "ask what was unplugged, restarted or zeroed before this run"
    parameters = (Parameter("jump", "", 0.0, 0.01, 0.2, "x, range as a share of full scale", signed=True),)

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return each channel once for each run after a break with which it may jump."""
        return from_each_run(super().places_in(compiled, recorded), recorded)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return changed(reading, place, lambda seen: seen + values["jump"] * sets_in(place, trace.time))


class TrackerCreep(_OfRecording):
    """The tracker's stand gives, or warms in the sun."""

    name = "tracker_creep"
    title = "creep"
    physics = (
        "The stand slips or tilts, sun falls on it, or the floor under the robot settles: at the time t since the "
        "start of the campaign readings are p + t (v + w x p), by far more than a tracker in order drifts "
        "(tracker_drift)."
    )
    source = "range: 0.1 to 2 mm/h and mrad/h, above the drift of a tracker in order; assumed"
    advice = "look at the stand of the tracker and at the floor, and measure fixed points before and after"
    parameters = (
        *(Parameter(axis, "m/h", 0.0, 1e-4, 2e-3, f"v, rate along {axis}", signed=True) for axis in "xyz"),
        *(Parameter(f"r{axis}", "rad/h", 0.0, 1e-4, 2e-3, f"w, rate about {axis}", signed=True) for axis in "xyz"),
    )

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return the tracker."""
        return tracker(compiled, recorded)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        rate = vector_of(values, "") + np.cross(vector_of(values, "r"), reading.reflectors)
        return replace(reading, reflectors=reading.reflectors + trace.time[:, None, None] / HOUR * rate)


class TrackerStep(_OfRecording):
    """Somebody ran into the tracker between two runs."""

    name = "tracker_step"
    title = "jump of the frame"
    physics = "The tracker or the base was pushed between two runs: from then on readings are R(r) p + t."
    source = "range: 0.05 to 5 mm and 0.05 to 5 mrad, a push that nobody corrected; assumed"
    advice = "measure fixed points again; align each part of the session for itself"
    parameters = (
        *(Parameter(f"t{axis}", "m", 0.0, 5e-5, 5e-3, f"shift along {axis}", signed=True) for axis in "xyz"),
        *(Parameter(f"r{axis}", "rad", 0.0, 5e-5, 5e-3, f"turn about {axis}", signed=True) for axis in "xyz"),
    )

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return the tracker once for each run after a break with which it may jump."""
        return from_each_run(tracker(compiled, recorded), recorded)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        turned = reading.reflectors @ small_rotation(vector_of(values, "r")).T + vector_of(values, "t")
        jumped = sets_in(place, trace.time)[:, None, None]
        return replace(reading, reflectors=reading.reflectors + jumped * (turned - reading.reflectors))
