"""A prediction in sentences and rows, for the page and the terminal alike."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.predict.free import FREE
from bench.predict.freed import FreedFigure
from bench.predict.prediction import SEEN, ChannelError, MaybeAnew, PredictedRecording, Prediction, Stretch
from bench.report.diagnosis.names import channel_name, listed
from bench.report.diagnosis.numbers import shown, unit_name
from bench.report.diagnosis.recording_clock import recording_clock_of

ANSWERS = {"kept": "as promised", "less": "less than promised", "more": "more than promised", "not promised": ""}
MOST_NAMED = 3  # channels in a headline, and of what may be anew


@dataclass(frozen=True)
class ChannelRow:
    """One channel as it is shown; numbers in the unit that people read."""

    name: str
    unit: str
    rms: str
    promised: str
    answer: str
    nominal: str
    floor: str
    measured: str


def headline(prediction: Prediction) -> str:
    """Return what a prediction says in a sentence: first whether errors are larger than promised, then how many hold.

    An error that is smaller than promised is no fault of the model: the promise was too wide.
    """
    answers = prediction.answers
    if not answers:
        return (
            "This model promises nothing of a recording: it comes from no diagnosis, or from one that ended before it "
            "was done, or whose runs were too short or too few to tell how far others differ. Its errors stand below."
        )
    kept, less, count = answers.count("kept"), answers.count("less"), len(answers)
    more = _broken(prediction)
    within = f"{kept} of {count} {'lie' if count > 1 else 'lies'} in the promised interval{'s' if count > 1 else ''}"
    within += f", {less} below" if less else ""
    if not more:
        return f"No error is larger than promised ({within})."
    within += f", {len(more)} above"
    verb = "is" if len(more) == 1 else "are"
    named = f"above all those of {listed(more[:MOST_NAMED], 'and')}" if len(more) > MOST_NAMED else listed(more, "and")
    errors = "errors" if count > 1 else "error"
    return f"{len(more)} of {count} {errors} {verb} larger than promised: {named} ({within})."


def _broken(prediction: Prediction) -> list[str]:
    """Return the names of channels with errors larger than promised, the worst first."""
    beyond = {
        row_name(recording, channel): channel.rms / channel.high
        for recording in prediction.recordings
        for channel in recording.channels
        if channel.answer == "more"
    }
    return sorted(beyond, key=lambda name: -beyond[name])


def promise_sentence(prediction: Prediction) -> str:
    """Return what the intervals mean and how many may fail by chance; "" where nothing was promised."""
    count = len(prediction.answers)
    if not count:
        return ""
    about = (
        f"Each interval was promised to hold with 90 % at least, so of {count} about {0.1 * count:.1g} or fewer fail"
    )
    about += " by chance, above or below. They are about a recording of the same robot"
    if "payload" in prediction.free:
        return f"{about}, made at once or on another day; what it carries is fitted anew here."
    return f"{about} that carries what the model carries, made at once or on another day. {_carried(prediction)}"


def _carried(prediction: Prediction) -> str:
    """Return what the model carries beside what recordings state, and as in which recording."""
    mass = f"{prediction.carried_kg:.4g} kg at the load point" if prediction.carried_kg > 0 else "nothing"
    if not prediction.as_in:
        return f"It carries {mass}, beside what a recording states."
    return (
        f"It carries {mass}, beside what a recording states, as in {prediction.as_in}, the last of the recordings that "
        "it was made of; of these, too, it errs where another one carried something else."
    )


def broken_sentence(prediction: Prediction) -> str:
    """Return how to find out why errors are larger than promised; "" where none is."""
    if not prediction.is_broken:
        return ""
    return (
        "Where more fail than that: `--free payload` lets the robot carry something else, --free with other names lets "
        "instruments be set up anew, `bench diagnose CAMPAIGN --given MODEL` says what the model gets wrong about "
        "these data, `bench compare` what changed since those that it was made of."
    )


def free_sentence(prediction: Prediction) -> str:
    """Return what was fitted to the recordings."""
    if not prediction.free:
        return "Nothing was fitted to the data."
    anew = listed([FREE[name].words for name in prediction.free], "and")
    return f"Fitted anew to each recording: {anew}; beside what drifts from day to day, which is taken out again."


def row_name(recording: PredictedRecording, channel: ChannelError) -> str:
    """Return the name of a channel, with "at rest" and the recording where that is not clear."""
    of = f" ({recording.name})" if recording.name else ""
    return f"{_name_in(recording, channel)}{of}"


def _name_in(recording: PredictedRecording, channel: ChannelError) -> str:
    both = {one.kind for one in recording.channels if one.channel == channel.channel}
    where = " at rest" if channel.kind == "static" and len(both) > 1 else ""
    return f"{channel_name(channel.channel)}{where}"


def rows_of(recording: PredictedRecording) -> Iterator[ChannelRow]:
    """Yield the channels as they are shown, in the order of the recording."""
    for one in recording.channels:
        values = (one.rms, one.low, one.high, one.nominal, one.floor)
        rms, low, high, nominal, floor = shown(values, one.unit, one.rms / 10)  # three digits of the error
        (measured,) = shown((one.measured,), one.unit, one.measured / 10)
        kind = " at rest" if one.kind == "static" else ""
        promised = "" if one.answer == "not promised" else f"{low} to {high}"
        name = f"{channel_name(one.channel)}{kind}"
        yield ChannelRow(name, unit_name(one.unit), rms, promised, ANSWERS[one.answer], nominal, floor, measured)


def stretch_text(stretch: Stretch, recording: PredictedRecording) -> str:
    """Return a stretch in a line; where pictures show several runs one after another, with the time there."""
    rms, floor = shown((stretch.rms, stretch.floor), stretch.unit, stretch.rms / 10)
    when = f"{stretch.start_s:.1f} to {stretch.end_s:.1f} s of the run"
    if len({segment.run for segment in recording.linear.segments}) > 1:
        clock = recording_clock_of(recording.linear)
        seconds = clock.seconds[~clock.is_break]
        when += f", {seconds[stretch.first]:.1f} to {seconds[stretch.last]:.1f} s in the pictures"
    unit = unit_name(stretch.unit)
    return f"{channel_name(stretch.channel)}: {rms} {unit} in {stretch.label}, {when} (floor {floor} {unit})"


def exact_sentence(recording: PredictedRecording) -> str:
    """Return what fitted values are relative to, and on what their intervals rest; "" where nothing was fitted."""
    if not recording.freed:
        return ""
    model = (
        "takes all other figures of the model as exact, for there is no diagnosis that says how well they are known"
        if recording.is_exact
        else "how well the diagnosis knew the model: it is that of what differs between this recording and those that "
        "the model was made of, and the one in all is that of this recording"
    )
    return (
        "Each value is a difference from what the model has, with its 95 % interval. That counts what is another one "
        "on another day (offsets and constants of drives, friction, a tracker set up anew) as far as that drifts, and "
        f"{model}. Errors are those with what is free alone."
    )


def untold_sentence(recording: PredictedRecording) -> str:
    """Return what was free and the recording does not tell; "" where it tells everything that was free."""
    if not recording.untold:
        return ""
    names = listed(recording.untold, "and")
    return f"Not told by this recording: {names}. Any of these may be another one all the same."


def freed_text(figure: FreedFigure) -> str:
    """Return what was fitted anew in a line: its difference from what the model has, and both together if known."""
    factor, unit = (1.0, figure.unit) if figure.unit else (100.0, "%")
    values = [factor * x for x in (figure.found, figure.low, figure.high)]
    value, low, high = (_signed(x) for x in shown(values, unit, (values[2] - values[1]) / 2))
    words = f"{figure.name}: {value} {unit_name(unit)} ({low} to {high}) relative to "
    if np.isfinite(figure.model):
        half = (values[2] - values[1]) / 2
        totals = (figure.model, figure.total, figure.total_low, figure.total_high)
        model, total, lowest, highest = shown([factor * x for x in totals], unit, half)
        within = f" ({lowest} to {highest})" if np.isfinite(figure.total_low) else ""
        words += f"the {model} {unit_name(unit)} of the model, so {total} {unit_name(unit)}{within} in all"
    else:
        words += "what the model has"
    trades = f"; trades against {figure.trades_with} ({figure.correlation:+.2f})" if figure.trades_with else ""
    stated = shown((factor * figure.sigma,), unit, factor * figure.sigma)[0] if np.isfinite(figure.sigma) else ""
    prior = f"; stated within {stated} {unit_name(unit)}" if stated else ""
    return f"{words}{prior}{trades}"


def anew_sentence(recording: PredictedRecording) -> str:
    """Return what the lines of what may be anew mean; "" where nothing may be."""
    if not recording.maybe_anew:
        return ""
    return (
        "May be anew in this recording, each with what the model would leave if it alone were fitted, or it beside "
        "those that are named with it; what those above it explain is left out, and another cause may look like it. "
        "Nothing of this is in the errors above; `--free NAME` fits it and says what it is."
    )


def anew_text(one: MaybeAnew, recording: PredictedRecording) -> str:
    """Return what may be anew in a line: which errors it would change most, and by how much."""
    channels = zip(recording.channels, one.before, one.rms, strict=True)
    ratios = sorted(
        ((rms / before, before, rms, channel) for channel, before, rms in channels if before), key=lambda one: one[0]
    )
    better = [entry for entry in ratios if entry[0] < 1 - SEEN]
    worse = [entry for entry in reversed(ratios) if entry[0] > 1 + SEEN][:MOST_NAMED]
    words = [_change(before, rms, channel, recording) for _, before, rms, channel in better[:MOST_NAMED]]
    others = len(better) - MOST_NAMED
    changes = listed(words + ([f"{others} other{'s' if others > 1 else ''} less"] if others > 0 else []), "and")
    if worse:
        poorer = [_change(before, rms, channel, recording) for _, before, rms, channel in worse]
        changes += f", but {listed(poorer, 'and')}"
    (evidence,) = shown((one.log_evidence,), "", one.log_evidence / 10)
    beside = f", beside {listed([f'`--free {name}`' for name in one.beside], 'and')}" if one.beside else ""
    return f"`--free {one.name}`, {FREE[one.name].words}{beside} (evidence +{evidence}): {changes}"


def _change(before: float, rms: float, channel: ChannelError, recording: PredictedRecording) -> str:
    now, then = (shown((value,), channel.unit, value / 10)[0] for value in (before, rms))
    return f"{_name_in(recording, channel)} {now} -> {then} {unit_name(channel.unit)}"


def _signed(text: str) -> str:
    """Return a number with its sign, so that it reads as a difference."""
    return text if text.startswith("-") or text == "-" or float(text) == 0 else f"+{text}"
