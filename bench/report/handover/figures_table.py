"""The table of everything that was fitted: `figures.csv`, and what has moved in words."""

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields, replace

import numpy as np

from bench.diagnose.cross_validation.figures import FittedFigure
from bench.effects.nominal import PRESLIDING
from bench.report.diagnosis.numbers import shown, unit_name

COLUMNS = tuple(field.name for field in fields(FittedFigure))
SHARE = "share"  # in place of a unit


def csv_of(figures: Iterable[FittedFigure]) -> str:
    """Return the table as CSV, a row for each; SI units, as many digits as were fitted, empty where undefined.

    What a column means stands in README.md, and is the same in every row; yes is 1, no is 0.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for figure in figures:
        named = replace(figure, unit=figure.unit or SHARE)
        values = (getattr(named, name) for name in COLUMNS)
        plain = (int(value) if isinstance(value, bool) else value for value in values)
        writer.writerow("" if isinstance(value, float) and np.isnan(value) else value for value in plain)
    return text.getvalue()


def moved_sentences(figures: Sequence[FittedFigure]) -> Iterator[str]:
    """Yield a sentence for every figure that was found further away than its stated uncertainty explains.

    Those whose interval holds what was expected come last. What has changed since an earlier diagnosis is said
    elsewhere (`report/diagnosis/changed.py`).
    """
    moved = [figure for figure in figures if figure.has_moved and not figure.has_changed]
    for figure in sorted(moved, key=_may_be_as_expected):
        far = f"{abs(figure.sigmas):.1f} times its {'stated ' if np.isnan(figure.earlier) else ''}uncertainty"
        yield f"{figure.name}: {_size(figure)}, {far}{_unsure(figure)}{_trade(figure)}{_as_seen(figure)}"


def _may_be_as_expected(figure: FittedFigure) -> bool:
    """Whether its interval holds what was stated of it, or found before."""
    return figure.low <= (figure.stated if np.isnan(figure.earlier) else figure.earlier) <= figure.high


def _unsure(figure: FittedFigure) -> str:
    if not _may_be_as_expected(figure):
        return ""
    before = "the stated value" if np.isnan(figure.earlier) else "the value found before"
    return f"; its interval holds {before}, so by itself it shows nothing"


def _size(figure: FittedFigure) -> str:
    values, half = (figure.found, figure.low, figure.high), (figure.high - figure.low) / 2
    factor, unit = (1.0, figure.unit) if figure.unit else (100.0, "%")
    before = figure.stated if np.isnan(figure.earlier) else figure.earlier
    then, value, low, high = shown([factor * x for x in (before, *values)], unit, factor * half)
    if before:
        return f"{value} {unit_name(unit)} ({low} to {high}) instead of {then}"
    sign = "" if value.startswith("-") else "+"
    return f"{sign}{value} {unit_name(unit)} ({low} to {high})"


def _as_seen(figure: FittedFigure) -> str:
    if not figure.name.startswith(PRESLIDING):
        return ""
    return (
        "; as replays of rests see it, which made it up to three times too soft on motor sides, and eight times too "
        "stiff on link sides, that were known"
    )


def _trade(figure: FittedFigure) -> str:
    if not figure.trades_with:
        return ""
    return f"; it trades against {figure.trades_with} (correlation {figure.correlation:+.2f})"
