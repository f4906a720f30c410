"""Channels that a recording may have wrong, and how much is plausible there."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

import numpy as np

from bench.effects.effect import Array, Effect, Place
from bench.effects.places import most_torque
from bench.effects.recorded import NOTHING_RECORDED, Recorded, RecordedRun
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading

TRACKER = Place("channel", 0, "tracker")
GAUGE = Place("channel", 0, "gauge")
FORCE = Place("channel", 0, "force sensor")
FIELDS = {"current": ("current",), "tau": ("torque",), GAUGE.name: ("gas_pressure",), FORCE.name: ("force", "moment")}


class OfCampaign(Effect):
    """An effect whose places are known of a campaign alone."""

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return no place: what was recorded is not known."""
        return self.places_in(compiled, NOTHING_RECORDED)


def drive_channels(compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
    """Return the channel by which each drive is compared: its current, else the torque that it reports."""
    found = []
    for j, slides in enumerate(compiled.is_slide):
        names = f"current_{j + 1}_a", f"tau_motor_{j + 1}_{'n' if slides else 'nm'}"
        found += [Place("channel", j, name) for name in names if name in recorded.columns][:1]
    return tuple(found)


def gauge(compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
    """Return the gauge of the counterbalance, if it was read."""
    fitted = compiled.counterbalance is not None and compiled.robot.figures.instruments.pressure is not None
    return (GAUGE,) if fitted and "gas_pressure_pa" in recorded.columns else ()


def force_sensor(recorded: Recorded) -> tuple[Place, ...]:
    """Return the force sensor, if it was read."""
    return (FORCE,) if recorded.columns.intersection(columns_of(FORCE)) else ()


def tracker(compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
    """Return the tracker, if it was there."""
    fitted = compiled.robot.figures.instruments.tracker is not None
    return (TRACKER,) if fitted and any(name.startswith("reflector_") for name in recorded.columns) else ()


def columns_of(place: Place) -> tuple[str, ...]:
    """Return the columns of a channel or instrument; those of the tracker are all of its first reflector."""
    several = {
        TRACKER.name: tuple(f"reflector_1_{axis}_m" for axis in "xyz"),
        GAUGE.name: ("gas_pressure_pa",),
        FORCE.name: tuple(f"force_{axis}_n" for axis in "xyz"),
    }
    return several.get(place.name, (place.name,))


def from_each_run(places: Iterable[Place], recorded: Recorded) -> tuple[Place, ...]:
    """Return places once for each run with which something may set in there.

    A drive that stands shows what friction holds, so nobody sees there when its zero jumped.
    """

    def shows(place: Place, run: RecordedRun) -> bool:
        is_seen = not run.columns.isdisjoint(columns_of(place))
        return is_seen and (place in (TRACKER, GAUGE, FORCE) or place.index in run.moving)

    return tuple(
        replace(place, since=run.name, since_s=run.start_s)
        for place in places
        for run in recorded.setting_in(partial(shows, place))
    )


def full_scale(compiled: CompiledRobot, place: Place) -> tuple[float, str]:
    """Return what a channel with one number shows at most in use, and its unit."""
    limit, slides = most_torque(compiled, place.index), compiled.is_slide[place.index]
    if place.name.startswith("current"):
        return limit / float(compiled.torque_constant[place.index]), "A"
    if place.name.startswith("tau"):
        return limit, "N" if slides else "Nm"
    fitted, balance = compiled.robot.figures.instruments.pressure, compiled.counterbalance
    assert place.name == GAUGE.name
    assert fitted
    assert balance
    return float(balance.force(0.0)) / fitted.piston_area_m2, "Pa"


def changed(reading: Reading, place: Place, change: Callable[[Array], Array]) -> Reading:
    """Return a reading in which a channel shows something else.

    Args:
        reading: Without it.
        place: The channel.
        change: From what it shows, shape (T,), of the force sensor (T, 3), to what it shows instead.
    """
    fields = next(fields for start, fields in FIELDS.items() if place.name.startswith(start))
    new = {}
    for field in fields:
        values: Array = getattr(reading, field)
        if field in ("current", "torque"):
            values = values.copy()
            values[:, place.index] = change(values[:, place.index])
        else:
            values = change(values)
        new[field] = values
    return replace(reading, **new)


def sets_in(place: Place, time: Array) -> Array:
    """Return 1 from the time on at which something sets in at a place, and 0 before, shape (T,)."""
    after: Array = np.where(time >= place.since_s, 1.0, 0.0)
    return after
