"""The headline of a verdict: large findings, the surest first, in two lines at most."""

from collections.abc import Sequence
from itertools import product

from bench.diagnose.verdict import NamedCause, Verdict
from bench.report.diagnosis.names import (
    capital,
    cause_name,
    cause_names,
    channel_name,
    interval_of,
    listed,
    ordered,
    unit_name,
    unlisted_name,
)

# Characters of two lines of the page's title: 56 rem between the margins, a letter of 1.4 rem is 0.65 of that wide in a
# wide bold face (61 a line).
MOST = 120
UNDECIDED = ", which these data cannot tell apart"


def headline(verdict: Verdict) -> str:
    """Return the verdict in one sentence of `MOST` characters; of one that is unfinished, that first.

    Large findings stand in it, the surest first; small ones only where there is no other, as such.
    """
    if not verdict.unfinished:
        return _headline(verdict, MOST)
    ended = f"Unfinished ({verdict.unfinished.why}, during: {verdict.unfinished.during})"
    if verdict.kind == "nothing weighed":
        return f"{ended}: nothing was weighed yet, so nothing is known of any cause."
    if verdict.kind == "nothing found so far":
        return f"{ended}: nothing was found so far."
    found = f"{ended}. So far: "
    return found + _headline(verdict, MOST - len(found))


def _headline(verdict: Verdict, room: int) -> str:
    shape = verdict.unlisted if verdict.unlisted and verdict.unlisted.stands_out else None
    large = any(not cause.is_small for explanation in verdict.explanations for cause in explanation.causes)
    if shape:
        name = unlisted_name(shape)
        if large:
            besides = (f"; and an unlisted {name.partition(' ')[2]}.", f"; and something unlisted at {shape.place}.")
            for beside in besides:
                if words := _large(verdict, room - len(beside)):
                    return capital(words + beside)
            return f"Several causes, listed below{besides[1]}"
        words = f"An unlisted cause: {name}"
        why = ", which no effect of the catalogue explains."
        return words + (why if len(words + why) <= room else ".")
    if large:
        return capital(f"{_large(verdict, room - 1) or 'Several causes, listed below'}.")
    if verdict.explanations:
        names = cause_names(ordered(verdict.explanations[0].causes))
        start = "Only small findings: "
        return f"{start}{_fitting(names, 'and', room - len(start) - 1) or 'listed below'}."
    if verdict.unlisted:
        return "Nothing listed was found, but something is left that is too small to give a shape."
    if verdict.noisy:
        worst = channel_name(verdict.noisy[0].column)
        return f"Nothing found, but {worst} scatters {verdict.noisy[0].times:.3g} times as much as its instrument."
    return "Nothing found: the nominal model explains this campaign."


def _large(verdict: Verdict, room: int) -> str:
    """Return the large causes that all explanations share, and those that are open between them; "" without room."""
    keys = [{_key(cause) for cause in e.causes} for e in verdict.explanations]
    shared = set.intersection(*keys)
    large = {_key(cause) for e in verdict.explanations for cause in e.causes if not cause.is_small}
    common = [cause for cause in ordered(verdict.explanations[0].causes) if _key(cause) in shared & large]
    rests = [[cause for cause in ordered(e.causes) if _key(cause) not in shared] for e in verdict.explanations]
    if large <= shared:
        return _together(common, room)
    rest = [" with ".join(cause_names(causes)) or "nothing else" for causes in rests]
    shared_words = [listed(cause_names(common), "and"), f"{len(common)} causes"] if common else [""]
    open_words = [f"either {listed(rest, 'or')}", f"one of {len(rest)} explanations"]
    for first, second in product(shared_words, open_words):
        words = ", and ".join(filter(None, (first, second))) + UNDECIDED
        if len(words) <= room:
            return words
    return f"{len(rest)} explanations{UNDECIDED}"


def _together(causes: Sequence[NamedCause], room: int) -> str:
    """Return causes of one explanation, a single one with its size; "" where there is room for none."""
    if len(causes) == 1:
        (cause,) = causes
        first = cause.parameters[0]
        value, low, high = interval_of(first)
        size = f"{first.name} {value} {unit_name(first.unit)}".rstrip()
        words = f"{cause_name(cause)}: {size} (95 % interval {low} to {high})"
        return words if len(words) <= room else _fitting([cause_name(cause)], "and", room)
    for start in (f"{len(causes)} causes act together: ", f"{len(causes)} causes: ", ""):
        if names := _fitting(cause_names(causes), "and", room - len(start)):
            return start + names
    return ""


def _fitting(names: Sequence[str], last: str, room: int) -> str:
    """Return names in a row, as many as there is room for and "others"; "" where there is room for none."""
    for count in range(len(names), 0, -1):
        some = listed([*names[:count], *["others"] * (count < len(names))], last)
        if len(some) <= room:
            return some
    return ""


def _key(cause: NamedCause) -> tuple[str, str]:
    return cause.effect, cause.place
