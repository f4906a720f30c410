"""The report of a diagnosis as one self-contained HTML page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.name.learned_shape import LearnedCurve
from bench.diagnose.verdict import ChannelGain, Verdict
from bench.report.diagnosis.baseline import MODELS, REPEATS, baseline_words, behind_sentence, drive_rows, links_sentence
from bench.report.diagnosis.blind import blind_sentences, not_looked_for, without_balance
from bench.report.diagnosis.changed import changed_lines
from bench.report.diagnosis.facts import Facts
from bench.report.diagnosis.headline import headline
from bench.report.diagnosis.names import (
    PART_OF_UNLISTED,
    UNTOLD,
    capital,
    cause_name,
    channel_name,
    effect_name,
    error_of,
    interval_of,
    limit_of,
    meaning_of,
    name_beside,
    parameter_text,
    place_name,
    remark_text,
    unlisted_name,
)
from bench.report.diagnosis.numbers import gain_percent, nats, percent, shown, unit_name
from bench.report.diagnosis.pictures import Picture, over_name
from bench.report.diagnosis.readings import Channel
from bench.report.diagnosis.rest import rest_share, rest_words
from bench.report.diagnosis.sentences import (
    FLOOR,
    confirmed_text,
    contradicted_sentences,
    gain_sentence,
    how_predicted,
    open_names_sentence,
    proposal_text,
    rate_sentence,
    remainder_sentence,
    scatter_sentence,
    step_left,
    steps_sentence,
    unconfirmed_text,
    undetectable_sentence,
    unfinished_sentence,
)
from bench.report.diagnosis.slow import slow_sentence
from bench.report.dynamics.notes import warming_notes
from bench.report.html import Filters, render

TEMPLATE = "diagnosis/page.html.j2"
MANY = 3  # findings; more are listed in a table before each is told
MOST_LINES = 300  # of a difference, on the page
HELD_OUT = {
    "recording": (
        "Each recording in turn was left out whole, and predicted by the models fitted to all others; what belongs to "
        "it alone, such as a payload or the zero of an encoder, was fitted to it."
    ),
    "run": "Each run in turn was left out whole, and predicted by the models fitted to all others.",
    "block": "One run shows nearly all of it, so stretches of it were left out in turn; that proves less than runs.",
}
FILTERS: Filters = {
    "capital": capital,
    "cause_name": cause_name,
    "channel": channel_name,
    "effect": effect_name,
    "place": place_name,
    "name_beside": name_beside,
    "interval": interval_of,
    "parameter": parameter_text,
    "meaning": meaning_of,
    "limit": limit_of,
    "error": error_of,
    "over": over_name,
    "remark": remark_text,
    "percent": percent,
    "gain_percent": gain_percent,
    "proposal": proposal_text,
    "step_left": step_left,
    "confirmed_text": confirmed_text,
    "unconfirmed_text": unconfirmed_text,
    "nats": nats,
    "spaced": lambda name: name.replace("_", " "),
    "unit": unit_name,
}


@dataclass(frozen=True)
class Pictures:
    """Everything that is drawn.

    Attributes:
        worst: Names of the worst channels, each with its pictures.
        learned: Curves of a learned shape.
        turns_round: Whether that shape turns its sign round with the direction of motion.
    """

    worst: tuple[tuple[str, tuple[Picture, ...]], ...]
    learned: tuple[Picture, ...] = ()
    turns_round: bool = False


@dataclass(frozen=True)
class Bars:
    """Two bars on a scale of 0 to 100, with an interval on the second and a mark across both; None: left out."""

    before: float
    after: float | None = None
    low: float | None = None
    high: float | None = None
    mark: float | None = None


@dataclass(frozen=True)
class GainRow:
    """One channel of the table of gains, as it is shown."""

    gain: ChannelGain
    name: str
    unit: str
    measured: str
    nominal: str
    fitted: str
    after: str
    floor: str
    bars: Bars


def page_of(
    verdict: Verdict,
    facts: Facts,
    pictures: Pictures,
    made: Mapping[str, str],
    difference: str,
    moved: Sequence[str] = (),
) -> str:
    """Return the page.

    Args:
        verdict: What it says.
        facts: What else it says.
        pictures: What is drawn.
        made: Files that stand beside it -> what they are.
        difference: Unified difference of the model as fitted, "" without one.
        moved: Stated figures that were found further away than their uncertainty explains, a sentence for each.
    """
    has_shape = verdict.unlisted is not None and verdict.unlisted.stands_out
    return render(
        TEMPLATE,
        FILTERS,
        part_of_unlisted=PART_OF_UNLISTED,
        untold=UNTOLD,
        floor_words=FLOOR,
        many=MANY,
        v=verdict,
        facts=facts,
        pictures=pictures.worst,
        learned=pictures.learned,
        turns_round=pictures.turns_round,
        tables=[(curve, _table(curve)) for curve in facts.learned],
        headline=headline(verdict),
        set_words=open_names_sentence(verdict),
        unfinished_words=unfinished_sentence(verdict),
        contradicted=list(contradicted_sentences(verdict)),
        rate_words=rate_sentence(verdict),
        gain_words=gain_sentence(verdict),
        steps_words=steps_sentence(verdict),
        how_predicted=how_predicted(verdict),
        scatter_words=scatter_sentence(verdict),
        unlisted_name=unlisted_name(verdict.unlisted) if verdict.unlisted and has_shape else "",
        remainder_words=remainder_sentence(verdict),
        rest=rest_share(verdict),
        rest_words=rest_words(verdict),
        undetectable_words=undetectable_sentence(verdict, [spot for spot in verdict.blind if spot.taken_by]),
        detectable=[limit for limit in verdict.detectable if limit.is_plausible],
        cause_title=_cause_title(verdict),
        held_out_words=HELD_OUT.get(verdict.held_out_by, ""),
        without_balance=without_balance(verdict),
        missing={", ".join(channels).replace("_", " "): names for channels, names in not_looked_for(verdict).items()},
        blind=list(blind_sentences(verdict)),
        has_shape=has_shape,
        has_after=any(channel.after is not None for channel in facts.channels),
        channels=_channels(facts.channels),
        gains=[_gain_row(gain) for gain in verdict.gain],
        baseline_words=baseline_words(verdict),
        baseline_models=list(MODELS.values()),
        baseline_rows=drive_rows(verdict),
        behind_words=behind_sentence(verdict),
        repeats_words=REPEATS if verdict.baseline and verdict.baseline.repeats else "",
        warming_words=" ".join(warming_notes(verdict.baseline.warming if verdict.baseline else None)),
        links_words=links_sentence(verdict),
        expected=[one for one in verdict.predicted if one.kind == "motion"],
        files=made,
        moved=moved,
        changed=list(changed_lines(verdict)),
        slow_words=slow_sentence(verdict.slow),
        difference=_lines(difference),
    )


def _cause_title(verdict: Verdict) -> str:
    if verdict.unlisted and verdict.unlisted.stands_out:
        return "Listed causes beside it"
    if len(verdict.findings) == 1:
        return "The cause" if len(verdict.findings[0].names) == 1 else "The cause is one of these"
    return "The causes, finding by finding"


def _channels(channels: tuple[Channel, ...]) -> list[tuple[Channel, Bars]]:
    """Return the channels, worst first, with their bars, all on one scale."""
    largest = max([1.0, *(max(c.before, c.after or 0.0) for c in channels)])
    rows = sorted(channels, key=lambda channel: -channel.before)
    scale = 100 / largest
    return [(c, Bars(scale * c.before, None if c.after is None else scale * c.after, mark=scale)) for c in rows]


def _gain_row(gain: ChannelGain) -> GainRow:
    values = (gain.measured, gain.nominal, gain.before, gain.after, gain.floor)
    measured, nominal, fitted, after, floor = shown(values, gain.unit, gain.floor or gain.after)
    row = GainRow(
        gain, channel_name(gain.channel), unit_name(gain.unit), measured, nominal, fitted, after, floor, Bars(0.0)
    )
    better = min(gain.before, gain.nominal)  # that `over_better` is over
    sizes = (gain.nominal, gain.after, gain.floor)
    if not np.all(np.isfinite(sizes)) or max(sizes) <= 0:
        return row
    scale = 100 / max(sizes)
    bars = Bars(gain.nominal * scale, gain.after * scale, mark=gain.floor * scale)
    if np.isfinite(gain.over_better_low) and np.isfinite(gain.over_better_high):
        shares = (1 - gain.over_better_high, 1 - gain.over_better_low)
        low, high = (float(np.clip(share * better * scale, 0.0, 100.0)) for share in shares)
        bars = replace(bars, low=low, high=high)
    return replace(row, bars=bars)


def _table(curve: LearnedCurve) -> list[tuple[str, ...]]:
    spread = max(curve.at) - min(curve.at)
    half = min(high - low for low, high in zip(curve.low, curve.high, strict=True)) / 2
    largest = max(abs(value) for value in curve.value)
    at = shown(curve.at, curve.over_unit, spread / 10)
    values = (shown(v, curve.unit, max(half, largest / 1000)) for v in (curve.value, curve.low, curve.high))
    return list(zip(at, *values, strict=True))


def _lines(difference: str) -> list[tuple[str, str]]:
    """Return the lines of a difference with what they are."""
    lines = difference.splitlines()
    cut = [f"... {len(lines) - MOST_LINES} more lines in the file"] if len(lines) > MOST_LINES else []
    kinds = {"+": "add", "-": "del"}
    return [(kinds.get(line[:1], "same"), line) for line in lines[:MOST_LINES] + cut]
