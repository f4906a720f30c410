"""The table of everything that was fitted: `figures.csv`, and what has moved in words."""

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields

import numpy as np

from bench.diagnose.cross_validation.figures import FittedFigure
from bench.effects.nominal import PRESLIDING
from bench.report.diagnosis.numbers import shown, unit_name

COLUMNS = tuple(field.name for field in fields(FittedFigure))


def csv_of(figures: Iterable[FittedFigure]) -> str:
    """Return the table as CSV, a row for each; SI units, as many digits as were fitted, empty where undefined."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for figure in figures:
        values = (getattr(figure, name) for name in COLUMNS)
        writer.writerow("" if isinstance(value, float) and np.isnan(value) else value for value in values)
    return text.getvalue()


def moved_sentences(figures: Sequence[FittedFigure]) -> Iterator[str]:
    """Yield a sentence for every stated figure that was found further away than its uncertainty explains."""
    for figure in figures:
        if not figure.has_moved:
            continue
        far = f"{abs(figure.sigmas):.1f} times its stated uncertainty"
        yield f"{figure.name}: {_size(figure)}, {far}{_trade(figure)}{_as_seen(figure)}"


def _size(figure: FittedFigure) -> str:
    values, half = (figure.found, figure.low, figure.high), (figure.high - figure.low) / 2
    factor, unit = (1.0, figure.unit) if figure.unit else (100.0, "%")
    stated, value, low, high = shown([factor * x for x in (figure.stated, *values)], unit, factor * half)
    if figure.stated:
        return f"{value} {unit_name(unit)} ({low} to {high}) instead of {stated}"
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
