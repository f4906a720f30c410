"""A first pass as text in the terminal."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.identify.dynamics.advice import sentence
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.quantities import NAMED, RELATIVE, Quantity
from bench.identify.dynamics.widths import AS_STATED
from bench.record.campaign import Array
from bench.record.finding import counted
from bench.report.diagnosis.numbers import shown, unit_name
from bench.report.dynamics.identify import Dynamics
from bench.report.dynamics.notes import notes_of
from bench.report.dynamics.words import MODELS, folds_words, torque_unit
from bench.report.tables import print_wide, terminal

if TYPE_CHECKING:
    from rich.table import Table

TERMS = 3  # of a base parameter, that the terminal has room for; dynamics.json has all of them
TITLES = {
    "payload": "payload and counterbalance",
    "gas": "payload and counterbalance",
    "level": "gravity in the frame of the base",
    "friction": "friction and offsets",
    "inertia": "base inertial parameters",
    "drive": "torque scale",
}


def print_dynamics(result: Dynamics, level: float) -> None:
    """Print errors first, then parameters, then what is not told and which motion would tell it."""
    found, console = result.found, terminal()
    for line in _head(found):
        console.print(line, highlight=False)
    errors = {model: found.held_out.rms(model) for model in MODELS}
    print_wide(console, _errors(found, f"held out: {folds_words(found)}, each predicted by a fit without it", errors))
    for folder, torques in result.predicted.items():
        print_wide(console, _errors(found, f"predicted, nothing fitted: {folder}", {m: torques.rms(m) for m in MODELS}))
    drives_without = _without(found)
    without = {f"{NAMED[what]} ({found.joints[j]})" for what, drives in drives_without.items() for j in drives}
    for title in dict.fromkeys(TITLES.values()):
        mine = [one for one in result.quantities if TITLES[one.kind] == title and one.told and one.name not in without]
        if mine:
            print_wide(console, _parameters(f"{title}, {level:.0%} intervals", mine, found.quantile(level)))
    if without:
        words = [f"{NAMED[what]} ({_joints(found, drives)})" for what, drives in drives_without.items() if drives]
        console.print(f"Not needed: {'; '.join(words)}.", highlight=False)
    open_ones = [
        one.name for one in result.quantities if not one.told and one.kind != "drive" and one.name not in without
    ]
    if open_ones:
        console.print(f"Not told by these data, left near what was stated: {', '.join(open_ones)}.", highlight=False)
    for motion in result.motions:
        console.print(sentence(motion, found), highlight=False)
    for note in notes_of(found, result.quantities, result.predicted):
        console.print(note, highlight=False)


def _without(found: FirstPass) -> dict[str, list[int]]:
    """Return which drives do without what a drive may have and was looked for, by its name as of `FirstPass.has`."""
    drives = range(len(found.joints))
    return {what: [j for j in drives if j not in has] for what, has in found.has.items() if found.looks_for(what)}


def _joints(found: FirstPass, drives: Sequence[int]) -> str:
    """Return the names of some joints, or that they are all."""
    return "all joints" if len(drives) == len(found.joints) else ", ".join(found.joints[j] for j in drives)


def _head(found: FirstPass) -> Iterator[str]:
    samples = [part.samples for part in found.stretches]
    seconds = sum(len(part) / part.rate for part in samples)
    runs = len({part.run for part in samples})
    rates = sorted({round(part.rate) for part in samples})
    band = found.band
    origin = "as stated" if np.isnan(band.bandwidth_hz) else f"ten times the {band.bandwidth_hz:.2g} Hz of the motion"
    yield (
        f"{counted(runs, 'run')}, {seconds:.0f} s at {', '.join(map(str, rates))} Hz; model and data "
        f"through one zero-phase low-pass of {band.cutoff_hz:.3g} Hz, {origin}."
    )
    if found.solution.delay_sigma > 0:
        late = _milliseconds(found, found.solution.delay, found.solution.delay_sigma)
        yield f"Torques are read {late} after the angles."
    else:
        beside = f" of {_milliseconds(found, *found.solution.not_taken)}" if found.solution.not_taken else ""
        yield (
            f"No delay of torques after angles is taken: with one{beside}, what was held out is not surely predicted "
            "better."
        )
    if found.solution.widths.scale != AS_STATED:
        yield (
            "Torques are taken as they are read: with their scales free, what was held out is predicted no better. "
            "Intervals count the scales as uncertain as stated."
        )


def _milliseconds(found: FirstPass, delay: float, sigma: float) -> str:
    late, half = 1e3 * delay, 1e3 * found.quantile() * sigma
    return f"{late:.2f} ms ({late - half:.2f} to {late + half:.2f})"


def _errors(found: FirstPass, title: str, errors: dict[str, Array]) -> "Table":
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        box=SIMPLE_HEAD, title_justify="left", title=f"error of the torque, RMS [{torque_unit(found)}]; {title}"
    )
    table.add_column("", no_wrap=True)
    for joint in found.joints:
        table.add_column(joint, justify="right")
    for model, words in MODELS.items():
        table.add_row(words, *("-" if np.isnan(value) else f"{value:.4g}" for value in errors[model]))
    return table


def _parameters(title: str, rows: list[Quantity], quantile: float) -> "Table":
    lumped = any(one.meaning for one in rows)
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD)
    for name in ("", "nominal", "found", "interval", "unit", *(["with it"] if lumped else [])):
        table.add_column(name, justify="left" if name in ("", "unit", "with it") else "right")
    for one in rows:
        low, high = one.interval(quantile)
        unit, scale = ("%", 100.0) if one.unit == RELATIVE else (one.unit, 1.0)
        numbers = tuple(scale * value for value in (one.nominal, one.value, low, high))
        nominal, found, *ends = shown(numbers, unit, (numbers[3] - numbers[2]) / 2)
        table.add_row(
            one.name, nominal, found, " to ".join(ends), unit_name(unit), *([_in_short(one.meaning)] if lumped else [])
        )
    return table


def _in_short(terms: Sequence[str]) -> str:
    more = len(terms) - TERMS
    return " ".join(terms[:TERMS]) + (f" and {more} more" if more > 0 else "")
