"""The headline of a verdict: large, confirmed findings, the largest first, in two lines; what is missing in two."""

from collections.abc import Sequence
from itertools import chain

from bench.diagnose.named_causes import ParameterValue
from bench.diagnose.verdict import AmbiguityGroup, NamedCause, Verdict
from bench.report.diagnosis.baseline import missed_sentence
from bench.report.diagnosis.changed import changed_sentence
from bench.report.diagnosis.left import left_sentence
from bench.report.diagnosis.names import (
    capital,
    cause_name,
    cause_names,
    channel_name,
    fitting,
    in_short,
    interval_of,
    listed,
    unlisted_name,
)
from bench.report.diagnosis.numbers import unit_name

# Characters of two lines of the page's title: 56 rem between the margins, a letter of 1.4 rem is 0.65 of that wide in a
# wide bold face (61 a line).
MOST = 120
UNDECIDED = ", which these data cannot tell apart"


def headline(verdict: Verdict) -> str:
    """Return the verdict in one sentence of `MOST` characters; of one that is unfinished, that first.

    Large findings that are confirmed stand in it, the largest first; the others are counted, and named only where there
    is no such finding. Sentences of their own say what is left beside it, that least squares predicts better for sure,
    and which figures have changed since the diagnosis from which this one started.
    """
    if not verdict.unfinished:
        more = (left_sentence(verdict), missed_sentence(verdict), changed_sentence(verdict))
        return " ".join(filter(None, (_headline(verdict, MOST), *more)))
    ended = f"Unfinished ({verdict.unfinished.why}, during: {verdict.unfinished.during})"
    if verdict.kind == "nothing weighed":
        return f"{ended}: nothing was weighed yet, so nothing is known of any cause."
    if verdict.kind == "nothing found so far":
        return f"{ended}: nothing was found so far."
    found = f"{ended}. So far: "
    return found + _headline(verdict, MOST - len(found))


def _headline(verdict: Verdict, room: int) -> str:
    shape = verdict.unlisted if verdict.unlisted and verdict.unlisted.stands_out else None
    large = bool(_of_headline(verdict))
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
        rest = _rest_words(verdict)
        words = _large(verdict, room - len(rest) - 1) or _counted(_of_headline(verdict), room - len(rest) - 1)
        return capital(f"{words}{rest}.")
    if verdict.findings:
        names = [in_short(_causes(group)) for group in verdict.findings]
        unsure = [_is_unconfirmed(group) for group in verdict.findings]
        kind = "that are not confirmed" if all(unsure) else "that are small or not confirmed"
        start = f"Only findings {kind}: " if any(unsure) else "Only small findings: "
        if verdict.unfinished and any(unsure):  # they have not failed: nothing was held against them
            start = "not yet checked on other data: "
        return f"{start}{fitting(names, 'and', room - len(start) - 1) or 'listed below'}."
    if verdict.unlisted:
        return "Nothing listed was found, but something is left that is too small to give a shape."
    if verdict.noisy:
        worst = channel_name(verdict.noisy[0].column)
        return f"Nothing found, but {worst} scatters {verdict.noisy[0].times:.3g} times as much as its instrument."
    if missed_sentence(verdict):
        return "Nothing found, but the nominal model does not explain this campaign."
    return (
        "Nothing found: the nominal model, with its figures fitted, explains this campaign; what moved far is listed."
    )


def _counted(groups: Sequence[AmbiguityGroup], room: int) -> str:
    """Return how many findings there are, and the first of them, where there is no room for all."""
    words = f"{len(groups)} findings, listed below; first {in_short(_causes(groups[0]))}"
    return words if len(words) <= room else "Several causes, listed below"


def _of_headline(verdict: Verdict) -> list[AmbiguityGroup]:
    """Return the large and confirmed findings, without those that may be a part of the unlisted cause that it names.

    What is surely larger than one that may be large stands with it.
    """
    is_named = verdict.unlisted is not None and verdict.unlisted.stands_out
    large = [
        group
        for group in verdict.findings
        if not (group.is_small or _is_unconfirmed(group) or (is_named and group.may_be_unlisted))
    ]
    least = min((group.rank for group in large), default=None)
    return [group for group in verdict.findings if group in large or (least and _leads(group, least))]


def _leads(group: AmbiguityGroup, least: tuple[float, float]) -> bool:
    """Whether a small finding is confirmed and surely larger than a large one may be."""
    return group.is_small and group.is_confirmed and not group.may_be_unlisted and group.rank > least


def _is_unconfirmed(group: AmbiguityGroup) -> bool:
    """Whether a finding is large and hangs on a few runs."""
    return not (group.is_small or group.is_confirmed)


def _rest_words(verdict: Verdict) -> str:
    """Return how many findings there are beside the large and confirmed ones, "" where there is none."""
    told = _of_headline(verdict)
    small = sum(group.is_small and group not in told for group in verdict.findings)
    unconfirmed = sum(map(_is_unconfirmed, verdict.findings))
    words = [f"{small} small one{'s' * (small > 1)}"] if small else []
    words += [f"{unconfirmed} not confirmed"] if unconfirmed else []
    return f"; and {listed(words, 'and')}" if words else ""


def _large(verdict: Verdict, room: int) -> str:
    """Return the large findings, each with the causes that may be behind it; "" without room."""
    large = _of_headline(verdict)
    others = verdict.other_explanations
    if not others and all(len(group.names) == 1 for group in large):
        kind = "large causes" if any(group.is_small for group in verdict.findings if group not in large) else "causes"
        return _together([group.names[0].cause for group in large], room, kind)
    words = UNDECIDED if not others else f", or another explanation{UNDECIDED}"
    names = [[_names(group) for group in large], [in_short(_causes(group)) for group in large]]
    for found in names:
        if len(text := listed(found, "and") + words) <= room:
            return text
    if len(text := listed(names[1], "and")) <= room:
        return text
    if len(large) == 1:
        rest = f"one of {len(large[0].names)} causes{words}"
        return rest if len(rest) <= room else ""
    count = f"{len(large)} findings"
    if some := fitting(names[1], "and", room - len(f"{count}: ")):
        return f"{count}: {some}"
    several = sum(len(group.names) > 1 for group in large)
    rest = count + (words if others else f", of {several} of which these data cannot tell the cause")
    return rest if len(rest) <= room else ""


def _names(group: AmbiguityGroup) -> str:
    names = _causes(group)
    return names[0] if len(names) == 1 else f"either {listed(names, 'or')}"


def _causes(group: AmbiguityGroup) -> list[str]:
    return [cause_name(one.cause) for one in group.names]


def _told(cause: NamedCause) -> ParameterValue | None:
    """Return the first size whose interval leaves out zero, the first of all if none does; None: none was fitted."""
    told = (one for one in cause.parameters if one.is_told and not one.low <= 0 <= one.high)
    return next(chain(told, cause.parameters), None)


def _together(causes: Sequence[NamedCause], room: int, kind: str) -> str:
    """Return causes of one explanation, a single one with its size, several as causes of a kind; "" without room."""
    if len(causes) == 1:
        (cause,) = causes
        shown = _told(cause)
        if shown is None:
            return fitting([cause_name(cause)], "and", room)
        value, low, high = interval_of(shown)
        size = f"{shown.name.replace('_', ' ')} {value} {unit_name(shown.unit)}".rstrip()
        words = f"{cause_name(cause)}: {size} (95 % interval {low} to {high})"
        return words if len(words) <= room else fitting([cause_name(cause)], "and", room)
    for start in (f"{len(causes)} {kind} act together: ", f"{len(causes)} {kind}: ", ""):
        if names := fitting(cause_names(causes), "and", room - len(start)):
            return start + names
    return ""
