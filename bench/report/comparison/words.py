"""A comparison in words for the terminal."""

from collections.abc import Iterator, Sequence

import numpy as np

from bench.compare.comparison import Change, ChangedFinding, Comparison, Component
from bench.compare.recordings import GAS_TEMPERATURE
from bench.diagnose.replay.levels import GAS_OF_THE_DAY
from bench.diagnose.replay.nuisances import THERMOMETER
from bench.report.comparison.names import (
    NOT_THE_MACHINES,
    along_words,
    change_name,
    course_words,
    drift_text,
    expected_text,
    explanation_name,
    interval_text,
    limit_words,
    names_together,
    names_told,
    size_text,
    title_of,
    unlisted_words,
)
from bench.report.diagnosis.headline import MOST, UNDECIDED
from bench.report.diagnosis.names import capital, channel_name, fitting, in_short, listed, without_range
from bench.report.diagnosis.names import title_of as named_as
from bench.report.diagnosis.numbers import percent

BEST_LIMITS = 8
MOST_TOLD = 6  # explanations that a terminal shows in full
SURE = 0.9  # declared, as of an interval: probability of a name from which on a headline says it without the others
TOP = 0.999  # exact: probability beyond which nothing is said to be more, as of `percent`
OTHERS = "; and others, listed below"
LEAST = 1e-12  # of a probability that is said: none is nothing
UNFINISHED = (
    "This comparison ended before it was done: what is named was not yet held against the noise that it leaves, nor "
    "against what it does beyond proportion, so chance names a change more often than is said here."
)
UNREAD_GAS = (
    f". Gas that was lost pulls less as colder gas does; a thermometer on each day ({GAS_TEMPERATURE}, a column or "
    "under known:) tells them apart"
)
NONLINEAR = 0.12  # of a signature; beyond, its size is not to be taken at its word (diagnose/linearise/README.md: 12 %)


def headline(comparison: Comparison) -> str:
    """Return what changed in one sentence; of a comparison that is unfinished, that first."""
    if not comparison.unfinished:
        return _headline(comparison)
    return f"Unfinished ({comparison.unfinished.why}, during: {comparison.unfinished.during}). So far: " + _headline(
        comparison
    )


def unfinished_sentence(comparison: Comparison) -> str:
    """Return what it means that a comparison is unfinished, "" where it is finished."""
    return UNFINISHED if comparison.unfinished else ""


def left_before_sentence(comparison: Comparison) -> str:
    """Return how far the robot is from what was recorded before, and what to do about it; "" where it is near."""
    if not comparison.left_before:
        return ""
    worst, *others = comparison.left_before
    before = _before(comparison)
    more = f", and other channels of it too ({len(comparison.left_before)} in all)" if others else ""
    remedy = (
        "that robot is of a diagnosis, so see what bench diagnose leaves of that channel, and state more noise for it "
        "(instruments in figures.yaml) if it scatters more than is stated"
        if comparison.robot != "fitted"
        else f"diagnose {before} first (bench diagnose) and compare with --robot and the folder of that diagnosis, or "
        "state in the folder of the robot what it lacks (a spring, a load, friction)"
    )
    return (
        f"The robot as it was leaves {worst.times:.2g} times as much of {channel_name(worst.column)} in {before} as "
        f"the noise of the instruments explains{more}, so names of what changed may be wrong: {remedy}."
    )


def diagnosed_sentence(comparison: Comparison) -> str:
    """Return that the robot as it was had to be diagnosed, and how that is made once for all; "" where it had not."""
    if comparison.robot != "diagnosed":
        return ""
    before = _before(comparison)
    return (
        f"The robot as it was is what a diagnosis of {before} found, for figures, friction and payload left more than "
        f"twice the noise. To compare with {before} again, bench diagnose it once, and give --robot the folder of that."
    )


def _before(comparison: Comparison) -> str:
    return listed([one.name for one in comparison.recordings if not one.is_after], "and")


def _headline(comparison: Comparison) -> str:
    if comparison.unlisted:
        course = course_words(comparison.unlisted, comparison)
        found = f"Changed, not listed: {unlisted_words(comparison.unlisted)}"
        return f"{found}, {course}." if course else f"{found}."
    if not comparison.explanations:
        return "Nothing changed that these recordings would show."
    best = comparison.explanations[0]
    if len(comparison.explanations) == 1 and len(best.changes) == 1:
        (change,) = best.changes
        first = change.sizes[0]
        amount = interval_text(first.per_week or first.change, first.unit) + (" a week" if first.per_week else "")
        when = course_words(change, comparison) if not first.per_week else ""
        said = (f"Changed: {change_name(change)} {amount}", when, f"probability {percent(best.probability)}")
        return ", ".join(part for part in said if part) + "."
    return f"Changed: {_findings(comparison, MOST - len('Changed: .'))}."


def _findings(comparison: Comparison, room: int) -> str:
    """Return what several findings are, the sure ones first, each by its likeliest name; of one, all its names."""
    sure = [one for one in comparison.findings if one.names[0].probability >= SURE]
    if not sure or len(comparison.findings) == 1:
        return _undecided(comparison.findings, room, is_open=comparison.has_other_explanations)
    first = sorted((one.names[0] for one in sure), key=lambda name: -name.probability)
    least = percent(first[-1].probability)
    more = " or more" if first[-1].probability <= TOP else ""  # there "> 99.9 %" begins
    each = f" (each {least}{more})" if len(first) > 1 else f" ({least})"
    others = [one for one in comparison.findings if one not in sure]
    beside = OTHERS if others else ""
    names = fitting(names_together(first), "and", room - len(each + beside)) or f"{len(first)} changes"
    if not others:
        return names + each
    undecided = _undecided(others, room - len(names + each) - 2, is_open=comparison.has_other_explanations)
    whole = f"{names}{each}; {undecided}"
    return whole if len(whole) <= room else names + each + beside


def _undecided(findings: Sequence[ChangedFinding], room: int, *, is_open: bool) -> str:
    """Return findings with all their names, in short where there is no room, as many as there is room for."""
    names = [[title_of(one.title, one.place) for one in finding.names] for finding in findings]
    undecided = ", or another explanation" * is_open + UNDECIDED * (is_open or any(len(own) > 1 for own in names))
    whole = [f"either {listed(own, 'or')}" if len(own) > 1 else own[0] for own in names]
    shorter = [[in_short(own, count) for own in names] for count in range(max(map(len, names)) - 1, 0, -1)]
    for text in (listed(whole, "and"), *(listed(short, "and") for short in shorter)):
        if len(text + undecided) <= room:
            return text + undecided
    short = [in_short(own) for own in names]
    if text := fitting(short, "and", room - len(undecided)):
        return text + undecided
    return short[0] if len(short) == 1 else f"{short[0]} and others"


def words_of(comparison: Comparison) -> Iterator[str]:
    """Yield the lines of a comparison for the terminal."""
    yield headline(comparison)
    if comparison.unfinished:
        yield unfinished_sentence(comparison)
    if comparison.left_before:
        yield left_before_sentence(comparison)
    if comparison.robot == "diagnosed":
        yield diagnosed_sentence(comparison)
    yield basis_sentence(comparison)
    if len(comparison.explanations) > 1:  # else the only one has them all
        yield from findings_sentences(comparison)
    yield from drift_sentences(comparison)
    for explanation in comparison.explanations[:MOST_TOLD]:
        yield f"{capital(explanation_name(explanation))}: probability {percent(explanation.probability)}"
        several = len(explanation.changes) > 1
        for change in explanation.changes:
            if several:
                yield f"  {capital(change_name(change))}"
            yield from (f"{'  ' * several}{line}" for line in _change(change, comparison))
    if len(comparison.explanations) > MOST_TOLD:
        rest = comparison.explanations[MOST_TOLD:]
        each = f"{percent(rest[0].probability)} or less" + " each" * (len(rest) > 1)
        yield f"{len(rest)} more explanations ({each}) stand in compare.json and the page, with -o."
    if comparison.has_changed:
        yield f"That nothing changed has a probability of {percent(max(comparison.probability_unchanged, LEAST))}."
    yield from limits_sentences(comparison)


def findings_sentences(comparison: Comparison) -> Iterator[str]:
    """Yield each of several changes with the causes that may be behind it; nothing where there is one."""
    if len(comparison.findings) > 1:
        for i, finding in enumerate(comparison.findings, 1):
            yield f"Change {i}: {listed([str(one) for one in names_told(finding, comparison)], 'or')}"


def basis_sentence(comparison: Comparison) -> str:
    """Return what was compared, and at which rate chance alone is taken for a change."""
    before = [one.name for one in comparison.recordings if not one.is_after]
    after = [one for one in comparison.recordings if one.is_after]
    met = float(np.mean([one.coinciding for one in after]))
    same = (
        f"{percent(met)} of the instants after repeat a state from before, where everything that stayed cancels"
        if met > 0
        else "no instant repeats a state from before, so all that stayed has to be told apart by the model"
    )
    left_out = (
        f" Left out: {listed(comparison.left_out, 'and')}, read before or after alone." if comparison.left_out else ""
    )
    return (
        f"{listed([one.name for one in after], 'and')} against {listed(before, 'and')}: {same}.{left_out} Chance alone "
        f"names a change on {percent(comparison.false_alarm_rate)} of machines that stayed as they were."
    )


def drift_sentences(comparison: Comparison) -> Iterator[str]:
    """Yield, for each kind of figure that drifts from day to day, what that took of the difference, where told."""
    places: dict[tuple[str, str, float], list[str]] = {}
    for drift in comparison.drifts:
        title, place = (drift.name, "") if drift.name in (GAS_OF_THE_DAY, THERMOMETER) else named_as(drift.name)
        text = drift_text(drift.values[-1], drift.unit)
        places.setdefault((title, drift.unit, drift.expected), []).append(f"{place} {text}".lstrip())
    last = comparison.recordings[-1].name
    reads_gas = any(one.column == GAS_TEMPERATURE for one in comparison.noise)
    for (title, unit, expected), values in places.items():
        yield (
            f"Drift of the day in {last}, which is not counted as a change: {title}: {'; '.join(values)} "
            f"(90 % intervals; a difference with a standard deviation of {expected_text(expected, unit)} was expected)"
            f"{UNREAD_GAS if title == GAS_OF_THE_DAY and not reads_gas else ''}"
        )


def limits_sentences(comparison: Comparison) -> Iterator[str]:
    """Yield what would have been found, and what would not."""
    open_ones = [one for one in comparison.components if not one.is_named]
    seen = [one for one in open_ones if one.limit < one.plausible]
    if seen:
        some = [f"{_component(one)} {limit_words(one)}" for one in seen[:BEST_LIMITS]]
        yield f"Would have been found from these sizes on: {'; '.join(some)} ({len(seen)} in all)."
    unseen = len(open_ones) - len(seen)
    if unseen:
        yield (
            f"{unseen} change{'s' * (unseen > 1)} would not have been found at any plausible size; the page lists "
            f"{'them' if unseen > 1 else 'it'}."
        )


def _change(change: Change, comparison: Comparison) -> Iterator[str]:
    course = course_words(change, comparison)
    for size in change.sizes:
        yield f"  {size_text(size)}{f', {course}' if course else ''}   {without_range(size.words)}".rstrip()
    if along := along_words(change):
        yield f"  {capital(along)}."
    if change.advice:
        yield f"  Check: {change.advice}."
    if change.level in NOT_THE_MACHINES:
        yield f"  This is {NOT_THE_MACHINES[change.level]}."
    if change.nonlinearity > NONLINEAR:
        yield (
            f"  By simulation it acts {percent(change.nonlinearity)} otherwise than in proportion: take its size for a "
            "first guess, and bench diagnose for its value."
        )


def _component(one: Component) -> str:
    return f"{one.title}, {one.parameter.replace('_', ' ')}" if one.parameter != "change" else one.title
