"""Pictures of a prediction: the worst channels over time, measured and predicted, and what is left."""

import numpy as np

from bench.predict.errors import rms
from bench.predict.prediction import PredictedRecording
from bench.report.diagnosis.names import channel_name
from bench.report.diagnosis.numbers import shown, unit_name, workshop
from bench.report.diagnosis.pictures import BAND, SALT, Picture
from bench.report.diagnosis.recording_clock import recording_clock_of
from bench.report.figures.style import COLOURS, GREY, INK, PALE, SMALL_TEXT, small_figure, svg_of

WORST = 3  # channels that are drawn
SIZE = (4.6, 3.9)  # [inch]; on a telephone it fills the width


def pictures_of(recording: PredictedRecording) -> tuple[tuple[str, Picture], ...]:
    """Return name and picture of the channels that are furthest above what no model can predict."""
    columns = [quantity.column for quantity in recording.linear.quantities]
    ranked = sorted(recording.channels, key=lambda one: -one.rms / one.floor)
    worst = list(dict.fromkeys(one.channel for one in ranked))[:WORST]
    return tuple((channel_name(name), _picture(recording, columns.index(name))) for name in worst)


def _picture(recording: PredictedRecording, column: int) -> Picture:
    quantity = recording.linear.quantities[column]
    unit, scale = workshop(quantity.unit)
    clock = recording_clock_of(recording.linear)
    runs = list(dict.fromkeys(segment.run for segment in recording.linear.segments))
    several = len(runs) > 1
    time = np.concatenate([segment.motion.time[segment.motion.read] for segment in recording.linear.segments])
    seconds = clock.seconds if several else time[clock.frame] - recording.starts[runs[0]]
    measured, error = scale * recording.measured[:, column], scale * recording.error[:, column]
    measured = np.where(np.isfinite(error), measured, np.nan)
    nominal = measured - scale * recording.nominal_error[:, column]
    figure, rows = small_figure(2, 1, *SIZE, sharex=True)
    above, below = rows[0][0], rows[1][0]
    for values, words, colour, width in (
        (measured, "measured", GREY, 2.4),
        (nominal, "nominal", COLOURS[1], 0.8),
        (measured - error, "predicted", COLOURS[0], 1.0),
    ):
        above.plot(seconds, clock.curve(values), color=colour, linewidth=width, label=words)
    noise = clock.curve(scale * BAND * recording.noise[:, column])
    below.fill_between(seconds, -noise, noise, color=PALE, linewidth=0, label="floor, 95 %")
    below.axhline(0.0, color=INK, linewidth=0.6)
    below.plot(seconds, clock.curve(error), color=COLOURS[0], linewidth=0.9)
    size = rms(error[np.isfinite(error)] / scale)
    below.set_title(f"left: RMS {shown((size,), quantity.unit, size / 10)[0]} {unit}", loc="left")
    for panel in (above, below):
        panel.set_ylabel(f"[{unit_name(quantity.unit)}]")
        panel.grid(visible=False, axis="x")
    below.set_xlabel("time, runs one after another [s]" if several else "time in the run [s]")
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=SMALL_TEXT)
    name = channel_name(quantity.column)
    return Picture(
        svg_of(figure, SALT), f"{name} over time: measured, as the nominal robot has it, predicted; and what is left"
    )
