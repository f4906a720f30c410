"""The time series in the recording of a diagnosis: every channel measured and simulated, and what is left of it."""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array
from bench.report.diagnosis.names import capital, channel_name
from bench.report.diagnosis.numbers import workshop
from bench.report.diagnosis.readings import Readings
from bench.report.diagnosis.recording_clock import RecordingClock
from bench.report.recording.curves import Colour, Curve, Plot

WORST = 3  # channels under the first tab
# On black and on white, for colour-blind readers
MEASURED: Colour = (140, 140, 140)
WITHOUT: Colour = (213, 94, 0)
WITH: Colour = (86, 180, 233)
MEASURED_WIDTH, SIMULATED_WIDTH = 4.0, 1.5  # [px], so that a simulation that is right lies within what was measured


def plots_of(readings: Readings, time: RecordingClock) -> tuple[Plot, ...]:
    """Return the plots: the worst channels with what is left of them, all channels by kind, everything that is left."""
    found = []
    for c in readings.worst(WORST):
        found += [_channel("Worst channels", readings, c, time), _left("Worst channels", readings, c, time)]
    seen = [c for c in range(len(readings.quantities)) if np.any(readings.column == c)]
    found += [_channel(_kind(readings, c), readings, c, time) for c in seen]
    found += _all_left(readings, seen, time)
    return tuple(found)


def _channel(tab: str, readings: Readings, column: int, time: RecordingClock) -> Plot:
    quantity = readings.quantities[column]
    unit, scale = workshop(quantity.unit)

    def curve(name: str, values: Array, colour: Colour, width: float = SIMULATED_WIDTH) -> Curve:
        return Curve(name, scale * time.curve(values[:, column]), colour, width)

    curves = [
        curve("measured", readings.measured, MEASURED, MEASURED_WIDTH),
        curve("nominal" if readings.extended is None else "without", readings.simulated, WITHOUT),
    ]
    if readings.extended is not None:
        curves.append(curve("with", readings.extended, WITH))
    name = capital(channel_name(quantity.column))
    return Plot(tab, f"{name} [{unit}]", f"channels/{quantity.column}", tuple(curves))


def _left(tab: str, readings: Readings, column: int, time: RecordingClock) -> Plot:
    column_name = readings.quantities[column].column
    name = f"{capital(channel_name(column_name))}, left over [1: cannot be predicted]"
    return Plot(tab, name, f"left/{column_name}", tuple(_left_curves(readings, column, time)))


def _left_curves(readings: Readings, column: int, time: RecordingClock, prefix: str = "") -> Iterator[Curve]:
    mine = readings.column == column
    for name, values, colour in (("without", readings.before, WITHOUT), ("with", readings.after, WITH)):
        if values is not None:
            full = np.full(len(readings.run), np.nan)
            full[readings.instant[mine]] = values[mine]
            yield Curve(prefix + name, time.curve(full), colour, SIMULATED_WIDTH)


def _all_left(readings: Readings, seen: list[int], time: RecordingClock) -> Iterator[Plot]:
    for path in dict.fromkeys(readings.quantities[c].kind for c in seen):
        curves = []
        for c in seen:
            if readings.quantities[c].kind == path:
                prefix = f"{channel_name(readings.quantities[c].column)}, "
                curves += list(_left_curves(readings, c, time, prefix))
        kind = capital(channel_name(f"{path}_"))
        yield Plot("Left over", f"{kind}, left over [1: cannot be predicted]", f"left_of_kind/{path}", tuple(curves))


def _kind(readings: Readings, column: int) -> str:
    return capital(channel_name(f"{readings.quantities[column].kind}_"))
