"""A verdict in words: all of it for `verdict.txt`, and what decides for the terminal."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.diagnose.verdict import AmbiguityGroup, Verdict
from bench.report.diagnosis.baseline import baseline_lines
from bench.report.diagnosis.blind import blind_sentences, missing_sentences, without_balance
from bench.report.diagnosis.changed import changed_lines
from bench.report.diagnosis.file_names import DIFFERENCE, FIGURES, RECORDING, REPORT, ROBOT, TEXT, VERDICT
from bench.report.diagnosis.headline import headline
from bench.report.diagnosis.names import (
    PART_OF_UNLISTED,
    capital,
    cause_name,
    effect_name,
    error_text,
    limit_text,
    meaning_of,
    name_beside,
    parameter_text,
    place_name,
    remark_text,
)
from bench.report.diagnosis.numbers import percent
from bench.report.diagnosis.rest import rest_sentence
from bench.report.diagnosis.sentences import (
    FLOOR,
    confirmed_text,
    contradicted_sentences,
    gain_sentence,
    gain_text,
    how_predicted,
    left_text,
    open_names_sentence,
    proposal_text,
    rate_sentence,
    read_gains,
    refused_text,
    remainder_sentence,
    scatter_sentence,
    step_text,
    steps_sentence,
    unconfirmed_text,
    undetectable_sentence,
    unfinished_sentence,
)
from bench.report.diagnosis.slow import slow_sentence

BEST_CHANNELS = 4
BEST_PROPOSALS = 2
BEST_LIMITS = 5
BEST_RIVALS = 3
MOST_REFUSED, MOST_MOVED = 3, 5  # findings that were given up, and figures that moved, on the terminal
FOUND, NOTHING = "What was found, with 95 % intervals", "How sure that is"  # headings


@dataclass(frozen=True)
class Section:
    """Lines of a verdict that belong together.

    Attributes:
        title: What they are about, as a heading.
        lines: All of them, for `verdict.txt`.
        brief: Those for the terminal.
    """

    title: str
    lines: tuple[str, ...]
    brief: tuple[str, ...] = ()


def words_of(verdict: Verdict, moved: Sequence[str] = ()) -> Iterator[str]:
    """Yield the lines of a verdict, all that it says: what it is, what it is worth, what to do next.

    Args:
        verdict: The verdict.
        moved: A sentence for each stated figure that was found further away than its uncertainty explains.
    """
    yield from _first_of_all(verdict)
    for section in _sections(verdict, moved):
        yield from ("", section.title, *section.lines)


def brief_words(verdict: Verdict, moved: Sequence[str] = ()) -> Iterator[str]:
    """Yield the lines of a verdict for the terminal: what decides, and what else stands in `verdict.txt`.

    Args:
        verdict: The verdict.
        moved: A sentence for each stated figure that was found further away than its uncertainty explains.
    """
    yield from _first_of_all(verdict)
    sections = tuple(_sections(verdict, moved))
    for section in sections:
        if section.brief:
            yield from ("", section.title, *section.brief)
    more = [section.title for section in sections if not set(section.lines) <= set(section.brief)]
    if more:
        yield from ("", f"More in {TEXT} and on the page: {'; '.join(title[0].lower() + title[1:] for title in more)}.")


def _first_of_all(verdict: Verdict) -> Iterator[str]:
    """Yield the headline, and what it is not to be read without."""
    yield headline(verdict)
    if verdict.unfinished:
        yield unfinished_sentence(verdict)
    yield from contradicted_sentences(verdict)


def _sections(verdict: Verdict, moved: Sequence[str]) -> Iterator[Section]:
    """Yield the sections of a verdict that have lines."""
    found = tuple(_found(verdict, {}))
    refused = tuple(refused_text(step) for step in verdict.steps if not step.accepted)
    sections = (
        Section(FOUND if verdict.findings else NOTHING, found, tuple(_found(verdict, _worths(verdict)))),
        Section("What each finding is worth", tuple(_selection(verdict))),
        Section("What was refused", refused, _first(refused, MOST_REFUSED)),
        Section("What all of it is worth", tuple(_gain(verdict)), tuple(filter(None, (gain_sentence(verdict),)))),
        Section("Beside least squares", *2 * (tuple(baseline_lines(verdict)),)),
        Section("What is left, and what is promised of the next recording", tuple(_predicted(verdict))),
        Section("Figures that moved", tuple(moved), _first(moved, MOST_MOVED)),
        Section("What to do next", *2 * (tuple(_next(verdict)),)),
        Section("What these data cannot show", tuple(_not_shown(verdict))),
    )
    return (section for section in sections if section.lines)


def _found(verdict: Verdict, worths: Mapping[int, str]) -> Iterator[str]:
    """Yield what was found, and how sure it is.

    Args:
        verdict: The verdict.
        worths: Of findings, by their number, from 0: what each is worth, in a line.
    """
    for i, group in enumerate(verdict.findings):
        yield from _finding(group)
        if i in worths:
            yield f"{'':13}{worths[i]}"
    for explanation in verdict.other_explanations:
        name = name_beside(explanation, verdict.explanations[0])
        yield f"{percent(explanation.fitted_probability):>9}  altogether: {name}"
    if rest := rest_sentence(verdict):
        yield rest
    for line in changed_lines(verdict):
        yield f"Changed since the earlier diagnosis: {line}"
    if words := open_names_sentence(verdict):
        yield words
    if remainder := remainder_sentence(verdict):
        yield remainder
    if verdict.kind == "nothing found":
        yield rate_sentence(verdict)
        yield from _limits(verdict)
    if scatter := scatter_sentence(verdict):
        yield scatter


def _worths(verdict: Verdict) -> dict[int, str]:
    """Return what findings are worth: number of a finding -> a line.

    What one leaves where it is the only one stands in the table of what was held out.
    """
    taken = [step for step in verdict.steps if step.accepted]
    found = {}
    for i, group in enumerate(verdict.findings):
        causes = {(one.cause.effect, one.cause.place) for one in group.names}
        mine = [step for step in taken if causes & {(cause.effect, cause.place) for cause in step.added}]
        if not mine:
            continue
        left = left_text(mine[0], 1) if len(taken) > 1 else ""
        if worth := "; ".join(filter(None, (left, confirmed_text(mine[0])))):
            found[i] = worth
    return found


def _finding(group: AmbiguityGroup) -> Iterator[str]:
    for i, (cause, probability) in enumerate((one.cause, one.probability) for one in group.names):
        words = cause_name(cause) if i == 0 else f"or {cause_name(cause)}"
        yield f"{percent(probability):>9}  " + ", ".join(filter(None, (words, remark_text(cause, group))))
        for parameter in cause.parameters:
            meaning = meaning_of(parameter)
            yield f"{'':13}{parameter_text(parameter)}" + (f"   {meaning}" if meaning else "")
        if not cause.parameters:
            yield f"{'':13}no model with it was fitted: its size is not known"
        if cause.advice:
            yield f"{'':13}check: {cause.advice}"
    if group.may_be_unlisted:
        yield f"{'':11}or it is {PART_OF_UNLISTED}"


def _selection(verdict: Verdict) -> Iterator[str]:
    taken = [step for step in verdict.steps if step.accepted]
    if len(taken) > 1:
        yield (
            "Each finding beside all others: evidence, and that of data held out with its 90 % interval, in nats; and "
            "the error of what was held out, without it -> with it, all else fitted both times:"
        )
        for step in taken:
            yield f"  {step_text(step)}"
        if given_up := steps_sentence(verdict):
            yield given_up
    elif taken:
        yield from (f"{capital(text)}." for text in (confirmed_text(taken[0]), unconfirmed_text(taken[0])) if text)
    if verdict.rivals and not verdict.unlisted:
        ruled_out = "; ".join(name_beside(rival, verdict.explanations[0]) for rival in verdict.rivals[:BEST_RIVALS])
        others = len(verdict.rivals) - BEST_RIVALS
        yield f"Fitted, and ruled out: {ruled_out}{f'; {others} more (rivals in {VERDICT})' if others > 0 else ''}."


def _gain(verdict: Verdict) -> Iterator[str]:
    if verdict.gain:
        yield gain_sentence(verdict)
        known = [gain for gain in read_gains(verdict) if gain.over_better > 0]
        for gain in sorted(known, key=lambda gain: -gain.over_better)[:BEST_CHANNELS]:
            yield f"  {gain_text(gain)}"
        if known:
            yield f"  Readings count by the inverse of their floor variance; the floor is {FLOOR}."


def _predicted(verdict: Verdict) -> Iterator[str]:
    drives = [p for p in verdict.predicted if p.kind == "motion" and p.channel.startswith(("current", "tau_motor"))]
    if drives:
        yield (
            f"What the model leaves in motion, root mean square with every bin alike, {how_predicted(verdict)}, and "
            "what it promises of the next recording (90 %):"
        )
    for one in drives:
        yield f"  {error_text(one)}"
    if drives and (words := slow_sentence(verdict.slow)):
        yield words


def _next(verdict: Verdict) -> Iterator[str]:
    for proposal in verdict.next[:BEST_PROPOSALS]:
        yield f"Next: {proposal.experiment}"
        yield f"      {proposal_text(proposal)}"


def _not_shown(verdict: Verdict) -> Iterator[str]:
    yield from missing_sentences(verdict)
    yield from blind_sentences(verdict)
    for cause in without_balance(verdict):
        yield f"Not looked for: {cause}, whose model found no balance."


def _first(lines: Sequence[str], most: int) -> tuple[str, ...]:
    """Return the first lines, and how many more there are."""
    more = len(lines) - most
    return (*lines[:most], *([f"{more} more"] if more > 0 else []))


def _limits(verdict: Verdict) -> Iterator[str]:
    shown = [limit for limit in verdict.detectable if limit.is_plausible]
    if shown:
        yield "Larger ones would have been found, for instance of more than:"
        best = sorted(shown, key=lambda limit: (bool(limit.unit), limit.worst))
        for limit in best[:BEST_LIMITS]:
            where = place_name(limit.place)
            yield f"  {effect_name(limit.effect)}{f', {where}' if where else ''}: {limit_text(limit)}"
    if unseen := undetectable_sentence(verdict, but=verdict.blind):
        yield unseen


def places_of(folder: Path) -> Iterator[str]:
    """Yield where the files are and how to open them."""
    yield f"report     {folder / REPORT}"
    if (folder / RECORDING).is_file():
        yield f"recording  {folder / RECORDING}   (bench view {folder})"
    yield f"words      {folder / TEXT}"
    yield f"numbers    {folder / VERDICT}"
    if (folder / ROBOT).is_dir():
        yield f"robot      {folder / ROBOT}   (its change: {DIFFERENCE}; all that was fitted: {FIGURES})"
        yield f"apply      bench apply {folder} -o applied   (URDF, torques; more: bench/report/handover/README.md)"
    elif (folder / FIGURES).is_file():
        yield f"robot      none: what was fitted is no robot ({VERDICT}, handed_over: why); figures are in {FIGURES}"
