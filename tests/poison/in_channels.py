"""Tables that read well and are not what they say: units, lost samples, clocks, channels."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from tests.poison.in_tables import MOTION
from tests.poison.variant import Answer, Sheet, Spoil, Variant, exchanged, in_column, in_tables

OTHER = "joint1-payload5-speed30-up.csv"


def units(rng: np.random.Generator) -> Iterator[Variant]:
    found: dict[str, tuple[float, float, tuple[str, ...], Answer]] = {
        "degrees": (57.29578, 0, ("q_cmd_1_rad", "q_motor_1_rad"), "error"),
        "degrees of an encoder": (57.29578, 0, ("q_motor_2_rad",), "error"),
        "milliamperes": (1000, 0, ("current_1_a",), "error"),
        "millimetres": (1000, 0, ("reflector_1_x_m", "reflector_1_y_m", "reflector_1_z_m"), "error"),
        "degrees Celsius": (1, -273.15, ("gear_temperature_1_k",), "error"),
        "bar": (1e-5, 0, ("gas_pressure_pa",), "doubt"),
        "megapascal": (1e-6, 0, ("gas_pressure_pa",), "doubt"),
        "kilonewtons of a sensor": (1e-3, 0, ("force_z_n",), "error"),
        "kilonewtons of loads": (1e-3, 0, ("load_z_n",), "error"),
        "kilograms": (1 / 9.80665, 0, ("load_z_n",), "error"),
        "milliseconds": (1000, 0, ("time_s",), "doubt"),
    }
    for name, (factor, offset, columns, answer) in found.items():
        spoil = in_column(lambda v, f=factor, o=offset: f * v + o, *columns)
        yield Variant("units", name, spoil, answer, (columns[0],))


def _rows(change: Callable[[list[list[str]]], list[list[str]]]) -> Spoil:
    def of_motion(sheet: Sheet) -> None:
        if "pose" not in sheet.names:
            sheet.rows = change(sheet.rows)

    return in_tables(of_motion)


def lost_samples(rng: np.random.Generator) -> Iterator[Variant]:
    for share in (0.05, 0.1, 0.2, 0.2, 0.4):
        seed = int(rng.integers(1000))

        def some(rows: list[list[str]], share: float = share, seed: int = seed) -> list[list[str]]:
            kept = np.random.default_rng(seed).random(len(rows)) > share
            return [row for row, is_kept in zip(rows, kept, strict=True) if is_kept]

        yield Variant("lost samples", f"{share:.0%}, seed {seed}", _rows(some), "harmless", ("lost samples",))
    for begin in (0.2, 0.5):
        spoil = _rows(lambda rows, b=begin: rows[: int(b * len(rows))] + rows[int((b + 0.2) * len(rows)) :])
        yield Variant("lost samples", f"a fifth, from {begin:.0%} on", spoil, "harmless", ("lost samples",))


def _time(change: Callable[[np.ndarray], np.ndarray], table: str) -> Spoil:
    """Return what changes the time stamps of one table."""
    return in_tables(lambda sheet: sheet.change("time_s", change), table)


def clocks(rng: np.random.Generator) -> Iterator[Variant]:
    def swapped(values: np.ndarray) -> np.ndarray:
        values[[5, 6]] = values[[6, 5]]
        return values

    changes: dict[str, tuple[Callable[[np.ndarray], np.ndarray], Answer]] = {
        "two rows swapped": (swapped, "error"),
        "backwards": (lambda t: t[::-1].copy(), "error"),
        "stands": (lambda t: 0 * t, "error"),
        "standing once": (lambda t: np.where(np.arange(len(t)) == 7, t[6], t), "error"),
        "begins late": (lambda t: t + 1e4, "harmless"),
        "one gap of 30 years": (lambda t: t + 1e9 * (np.arange(len(t)) > 20), "error or harmless"),
    }
    for first, table in ((0, MOTION), (1, OTHER)):
        counted = _time(lambda t, first=first: first + np.arange(len(t)), table)
        yield Variant("clocks", f"rows counted from {first}", counted, "doubt", (table, "time_s", "row numbers?"))
    for at, count in ((1e9, 1), (1.7e9, 0)):

        def start(folder: Path, at: float = at, count: int = count) -> None:
            file = folder / "campaign.yaml"
            later = re.compile(r"(?<=start_s: )\S+")
            file.write_text(later.sub(lambda found: str(float(found[0]) + at), file.read_text(), count))

        yield Variant("clocks", f"start_s from {at:g}, {count or 'all'}", start, "doubt", ("start_s", "years"))
    for seed in (1, 2):  # nothing is said of a current, which follows from it

        def jitter(time: np.ndarray, seed: int = seed) -> np.ndarray:
            return time + np.random.default_rng(seed).uniform(-0.3, 0.3, len(time)) * (time[1] - time[0])

        words = (OTHER, "time_s", "times of arrival?", " 1 warning;")
        yield Variant("clocks", f"jitter of 30 %, {seed}", _time(jitter, OTHER), "harmless", words)
    for name, (change, answer) in changes.items():
        places = (MOTION, "time_s") if answer != "error or harmless" else ()
        yield Variant("clocks", name, _time(change, MOTION), answer, places)


def mistaken_channels(rng: np.random.Generator) -> Iterator[Variant]:
    minus = in_column(lambda v: -v, "q_motor_1_rad")
    yield Variant("mistaken channels", "an encoder turned", minus, "doubt", ("q_motor_1_rad",))
    for drive in (1, 2):
        name = f"current_{drive}_a"
        yield Variant("mistaken channels", f"{name} turned", in_column(lambda v: -v, name), "doubt", (name,))
        yield Variant("mistaken channels", f"{name} dead", in_column(lambda v: 0 * v, name), "doubt", (name,))
        of_motor = in_column(lambda v: v / 100, name)
        yield Variant("mistaken channels", f"{name} a hundredth", of_motor, "doubt", (name,))
    mirrored = in_column(lambda v: -v, "q_cmd_1_rad", "q_motor_1_rad")
    yield Variant("mistaken channels", "a mirrored joint", mirrored, "doubt", ())
    frozen = in_column(lambda v: 0 * v + v[0], "q_motor_1_rad")
    yield Variant("mistaken channels", "a frozen encoder", frozen, "doubt", ("q_motor_1_rad",))
    clipped = in_column(lambda v: np.minimum(v, v.min() + 0.6 * np.ptp(v)), "q_motor_1_rad")
    yield Variant("mistaken channels", "a clipped encoder", clipped, "doubt", ("q_motor_1_rad",))
    up = in_column(lambda v: -v, "load_z_n", "force_z_n")
    yield Variant("mistaken channels", "weights that pull up", up, "doubt", ("load_z_n",))

    swapped = exchanged("q_motor_1_rad", "q_motor_2_rad")
    yield Variant("mistaken channels", "encoders swapped", swapped, "doubt", ("q_motor_1_rad",))


def packets(rng: np.random.Generator) -> Iterator[Variant]:
    for of, apart in ((8, 1e-5), (20, 1e-6), (25, 1e-4)):

        def arrived(time: np.ndarray, of: int = of, apart: float = apart) -> np.ndarray:
            rows = np.arange(len(time))
            return time[rows // of * of] + rows % of * apart if np.median(np.diff(time)) > apart else time

        def spoil(sheet: Sheet, arrived: Callable[[np.ndarray], np.ndarray] = arrived) -> None:
            if "pose" not in sheet.names and len(sheet.rows) > 100:
                sheet.change("time_s", arrived)

        yield Variant(
            "packets", f"of {of}, {apart:g} s apart", in_tables(spoil), "error", ("time_s", "samples came in packets")
        )


FAMILIES = (units, lost_samples, clocks, mistaken_channels, packets)
