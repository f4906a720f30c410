"""What is left beside the causes in a headline: something too small to have a shape, and channels still missed."""

from bench.diagnose.verdict import ChannelGain, Unlisted, Verdict
from bench.report.diagnosis.names import channel_name
from bench.report.diagnosis.numbers import shown, unit_name
from bench.report.diagnosis.readings import STANDS_OUT
from bench.report.diagnosis.sentences import read_gains


def left_sentence(verdict: Verdict) -> str:
    """Return what is left beside the causes that were found, for the headline; "" where that is nothing to speak of.

    A channel is still missed where what the model leaves of it, held out, stands out of the floor: what a right
    model would leave, if the noise of instruments is as it is stated.
    """
    if not verdict.explanations:
        return ""
    missed = sorted(filter(_is_missed, read_gains(verdict)), key=_times, reverse=True)
    parts = []
    if verdict.unlisted and not verdict.unlisted.stands_out:
        parts.append(f"something at {verdict.unlisted.place} too small to have a shape{_at_most(verdict.unlisted)}")
    if missed:
        worst = missed[0]
        (size,) = shown((worst.after,), worst.unit, worst.floor)
        others = f", and {len(missed) - 1} more such channel{'s' * (len(missed) > 2)}" if len(missed) > 1 else ""
        parts.append(
            f"{channel_name(worst.channel)} errs by {size} {unit_name(worst.unit)}".rstrip()
            + f", {_times(worst):.2g} times what the noise of the instruments explains{others}"
        )
    return f"Left: {'; '.join(parts)}." if parts else ""


def _times(gain: ChannelGain) -> float:
    return gain.after / gain.floor


def _is_missed(gain: ChannelGain) -> bool:
    return gain.floor > 0 and _times(gain) > STANDS_OUT


def _at_most(unlisted: Unlisted) -> str:
    """Return how large a shape over nodes may be anywhere, by its 95 % band; "" where coefficients are no values."""
    known = [one for one in unlisted.parameters if one.name.startswith("at_")]
    if not known:
        return ""
    most = max(abs(end) for one in known for end in (one.low, one.high))
    (size,) = shown((most,), known[0].unit, most)
    return f" (at most {size} {unit_name(known[0].unit)})"
