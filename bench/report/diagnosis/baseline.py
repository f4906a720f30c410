"""Least squares beside a diagnosis, in words: its first lines, and the table of held-out torque errors."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from bench.diagnose.baseline.changed_friction import ChangedFriction
from bench.diagnose.baseline.first_look import FirstLook
from bench.diagnose.verdict import DriveErrors, Verdict
from bench.identify.dynamics.behind_gears import friction_share
from bench.report.diagnosis.names import capital, listed
from bench.report.diagnosis.numbers import percent
from bench.report.dynamics import words
from bench.report.dynamics.notes import behind_gears_notes, warming_notes

MODELS = {  # fields of `DriveErrors` -> what they are called
    "measured": words.MODELS["measured"],
    "nominal": words.MODELS["nominal"],
    "plain_least_squares": words.MODELS["rival"],
    "first_pass": words.MODELS["first_pass"],
    "diagnosed": "diagnosed model",
}
ONE_FRICTION = (
    "Least squares takes friction and offsets of drives to be the same in all recordings, and the payload where others "
    "do not surely predict better."
)
REPEATS = f"{words.REPETITION}: hold the model against one with bench predict."
NOTABLE = 1.05  # declared: ratio of errors, from where it is said
DIGITS = 3


def first_lines(look: FirstLook) -> Iterator[str]:
    """Yield what the first pass says before anything is diagnosed; nothing where nothing moves."""
    found = look.found
    if found is None:
        if look.why:
            yield f"No first pass by least squares: {look.why}"
        return
    seconds = sum(len(part.samples) / part.samples.rate for part in found.stretches)
    part = f" (the first {look.share:.0%} of each run)" if look.share < 1 else ""
    held_out = f"{words.folds_words(found)}, each predicted without it"
    yield (
        f"First pass: least squares of the rigid dynamics over {seconds:.0f} s of motion{part}. Torque, root mean "
        f"square of the error [{words.torque_unit(found)}] on {held_out}:"
    )
    rows = {name: found.held_out.rms(model).tolist() for model, name in words.MODELS.items()}
    yield from table_lines([f"drive {j + 1}" for j in range(len(found.joints))], rows)
    yield from behind_gears_notes(friction_share(found))
    if len({part.samples.recording for part in found.stretches}) > 1:
        yield f"{ONE_FRICTION} A diagnosis does not."
    worse = np.flatnonzero(np.array(rows[MODELS["plain_least_squares"]]) > np.array(rows[MODELS["measured"]])) + 1
    if len(worse):
        drives = f"drive{'s' * (len(worse) > 1)} {listed(list(map(str, worse)), 'and')}"
        yield (
            f"Plain least squares, which has no prior, errs by more than the torque itself on {drives}: what is left "
            "out moves in a way that the other runs do not show."
        )


def changed_lines(found: Iterable[ChangedFriction]) -> Iterator[str]:
    """Yield where recordings disagree about friction."""
    for one in found:
        levels = listed([f"{number(value)} {one.unit} in {name}" for name, value in one.found.items()], "and")
        yield (
            f"{one.name}, by least squares of each recording alone: {levels}. A diagnosis of both lets it differ, and "
            "hands over that of the last recording; bench compare tells what changed, and how surely."
        )


def baseline_lines(verdict: Verdict) -> Iterator[str]:
    """Yield the held-out errors of all models, and what they mean; nothing without a first pass."""
    baseline = verdict.baseline
    if baseline is None:
        return
    unit = " or ".join(dict.fromkeys(drive.unit for drive in baseline.drives))
    yield f"Torque in motion beside least squares, root mean square [{unit}], {baseline_words(verdict)}"
    rows = {title: [getattr(drive, name) for drive in baseline.drives] for name, title in MODELS.items()}
    yield from table_lines([f"drive {drive.drive}" for drive in baseline.drives], rows)
    if baseline.repeats:
        yield REPEATS
    yield from warming_notes(baseline.warming)
    if baseline.by == "recording":
        yield f"{ONE_FRICTION} The diagnosed model has those of the recording that is held out, fitted to it."
    yield from filter(None, (missed_sentence(verdict) or behind_sentence(verdict), links_sentence(verdict)))


def baseline_words(verdict: Verdict) -> str:
    """Return how the errors beside least squares were made; "" without any."""
    baseline = verdict.baseline
    if baseline is None:
        return ""
    held = {"recording": "recording", "run": "run", "block": "block of time"}[baseline.by]
    return f"at bins in which the drive moves, each {held} predicted by fits without it:"


def missed_sentence(verdict: Verdict) -> str:
    """Return where least squares predicts better for sure, "" where it does not; it fits into a headline."""
    missed = verdict.baseline.missed if verdict.baseline else ()
    if not missed:
        return ""
    worst = missed[0]
    least, ours = number(worst.least_squares), number(worst.diagnosed)
    model = "the named causes" if verdict.explanations or verdict.unlisted else "the model"
    more = f" (and {len(missed) - 1} more)" if len(missed) > 1 else ""
    errors = f"{_rival(worst.better)} predicts {least} {worst.unit}, {model} {ours}"
    return f"Drive {worst.drive}{more}: {errors}: something is missing here."


def behind_sentence(verdict: Verdict) -> str:
    """Return where least squares predicts better by what chance may bring about, "" where nowhere, or for sure."""
    behind: dict[str, list[str]] = {}
    for drive in verdict.baseline.drives if verdict.baseline else ():
        if drive.diagnosed > NOTABLE * drive.least_squares:
            words = f"{drive.drive} (by {percent(drive.diagnosed / drive.least_squares - 1)})"
            behind.setdefault(drive.better, []).append(words)
    if not behind or missed_sentence(verdict):
        return ""
    which = [
        f"{_rival(name)} leaves less on drive{'s' * (len(drives) > 1)} {listed(drives, 'and')}"
        for name, drives in behind.items()
    ]
    assert verdict.baseline
    held = f"{verdict.baseline.folds} {verdict.baseline.by}s that were held out one by one"
    return f"{capital(listed(which, 'and'))}; over {held} that is not beyond chance."


def _rival(name: str) -> str:
    """Return a row of least squares in a sentence, by the name that it has in the table."""
    return f"the {MODELS[name]}" if name == "first_pass" else MODELS[name]


def links_sentence(verdict: Verdict) -> str:
    """Return that links were taken as good as unknown, "" where they were not."""
    if verdict.links == 1:
        return ""
    return (
        "With masses and centres of mass of the links as certain as stated, least squares predicted better. They are "
        f"taken {verdict.links:.0f} times as uncertain here, and moments of inertia with them; what moved stands in "
        "figures.csv."
    )


def number(value: float) -> str:
    """Return an error with three digits, without an exponent."""
    if not np.isfinite(value):
        return "-"
    decimals = DIGITS - 1 - int(np.floor(np.log10(value))) if value > 0 else 0
    return f"{value:.{max(decimals, 0)}f}"


def table_lines(heads: Sequence[str], rows: Mapping[str, Sequence[float]]) -> Iterator[str]:
    """Yield a table of errors for the terminal."""
    first = max(map(len, rows))
    cells = {name: [number(value) for value in values] for name, values in rows.items()}
    widths = [max(len(head), *(len(row[i]) for row in cells.values())) for i, head in enumerate(heads)]
    for name, row in {"": list(heads), **cells}.items():
        yield "  " + "  ".join([name.ljust(first), *(cell.rjust(w) for cell, w in zip(row, widths, strict=True))])


def drive_rows(verdict: Verdict) -> tuple[tuple[DriveErrors, tuple[str, ...]], ...]:
    """Return each drive with its errors as they are shown, in the order of `MODELS`."""
    drives = verdict.baseline.drives if verdict.baseline else ()
    return tuple((drive, tuple(number(getattr(drive, name)) for name in MODELS)) for drive in drives)
