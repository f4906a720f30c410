"""Tables that read well and are not what they say: units, lost samples, clocks, channels."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import yaml

from tests.poison.in_tables import MOTION
from tests.poison.variant import Answer, Sheet, Spoil, Variant, in_column, tables

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
    def spoil(folder: Path) -> None:
        for file in tables(folder):
            sheet = Sheet(file)
            if "pose" not in sheet.names:
                sheet.rows = change(sheet.rows)
                sheet.write()

    return spoil


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

        def count(folder: Path, first: int = first, table: str = table) -> None:
            sheet = Sheet(folder / "runs" / table)
            sheet.change("time_s", lambda t, first=first: first + np.arange(len(t)))
            sheet.write()

        yield Variant("clocks", f"rows counted from {first}", count, "doubt", (table, "time_s", "row numbers?"))
    for at, count in ((1e9, 1), (1.7e9, 0)):

        def start(folder: Path, at: float = at, count: int = count) -> None:
            file = folder / "campaign.yaml"
            later = re.compile(r"(?<=start_s: )\S+")
            file.write_text(later.sub(lambda found: str(float(found[0]) + at), file.read_text(), count))

        yield Variant("clocks", f"start_s from {at:g}, {count or 'all'}", start, "doubt", ("start_s", "years"))
    for name, (change, answer) in changes.items():

        def spoil(folder: Path, change: Callable[[np.ndarray], np.ndarray] = change) -> None:
            sheet = Sheet(folder / "runs" / MOTION)
            sheet.change("time_s", change)
            sheet.write()

        yield Variant("clocks", name, spoil, answer, (MOTION, "time_s") if answer != "error or harmless" else ())


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

    def swap(folder: Path) -> None:
        for file in tables(folder):
            text = file.read_text()
            text = text.replace("q_motor_1_rad", "@").replace("q_motor_2_rad", "q_motor_1_rad")
            file.write_text(text.replace("@", "q_motor_2_rad"))

    yield Variant("mistaken channels", "encoders swapped", swap, "doubt", ("q_motor_1_rad",))


def _without(*prefixes: str) -> Spoil:
    """Return what takes columns out of every table."""

    def spoil(folder: Path) -> None:
        for file in tables(folder):
            sheet = Sheet(file)
            kept = [i for i, name in enumerate(sheet.names) if not name.startswith(prefixes)]
            sheet.names = [sheet.names[i] for i in kept]
            sheet.rows = [[row[i] for i in kept] for row in sheet.rows]
            sheet.write()

    return spoil


def _added(name: str, cell: str) -> Spoil:
    """Return what adds a column to every table."""

    def spoil(folder: Path) -> None:
        for file in tables(folder):
            sheet = Sheet(file)
            sheet.names.append(name)
            sheet.rows = [[*row, cell] for row in sheet.rows]
            sheet.write()

    return spoil


def _exchanged(first: str, second: str) -> Spoil:
    """Return what exchanges two columns in every table."""

    def spoil(folder: Path) -> None:
        for file in tables(folder):
            text = file.read_text().replace(first, "@").replace(second, first)
            file.write_text(text.replace("@", second))

    return spoil


def _both(*spoils: Spoil) -> Spoil:
    def spoil(folder: Path) -> None:
        for one in spoils:
            one(folder)

    return spoil


def _in_the_wrong_order(folder: Path) -> None:
    """Exchange the starts of the ways back of two joints."""
    file = folder / "campaign.yaml"
    content = yaml.safe_load(file.read_text())
    runs = {run["name"]: run for run in content["runs"]}
    one, other = runs["joint1-payload5-speed30-down"], runs["joint2-payload0-speed30-down"]
    one["start_s"], other["start_s"] = other["start_s"], one["start_s"]
    file.write_text(yaml.safe_dump(content))


def cross_checks(rng: np.random.Generator) -> Iterator[Variant]:
    """Channels that contradict each other or the model; what a diagnosis weighs itself is said, and no fault."""

    def smooth(values: np.ndarray) -> np.ndarray:
        if len(values) < 50:  # readings at rest
            return values
        return np.convolve(np.pad(values, (8, 0), mode="edge"), np.full(9, 1 / 9), "valid")

    def late(values: np.ndarray) -> np.ndarray:
        return values if len(values) < 50 else np.concatenate([np.full(5, values[0]), values[:-5]])

    def times(factor: float, *columns: str) -> Spoil:
        return in_column(lambda v: factor * v, *columns)

    loads, tracker = ("load_x_n", "load_y_n", "load_z_n"), tuple(f"reflector_1_{axis}_m" for axis in "xyz")
    found: dict[str, tuple[Spoil, Answer, tuple[str, ...]]] = {
        "a clock 10 % fast": (times(1.1, "time_s"), "doubt", ("time_s", "seconds for each second")),
        "a clock twice as fast": (times(2, "time_s"), "doubt", ("time_s", "seconds for each second")),
        "a clock ten times as fast": (times(10, "time_s"), "doubt", ("time_s", "seconds for each second")),
        "a clock half as fast": (times(0.5, "time_s"), "doubt", ("time_s", "seconds for each second")),
        "a current smoothed": (in_column(smooth, "current_2_a"), "doubt", ("current_2_a", "smoothed?")),
        "a tracker's axis smoothed": (in_column(smooth, tracker[0]), "doubt", (tracker[0], "smoothed?")),
        "kN without a sensor": (_both(_without("force", "moment"), times(1e-3, *loads)), "doubt", ("load_mass_kg",)),
        "kN without sensor and mass": (
            _both(_without("force", "moment", "load_mass"), times(1e-3, *loads)),
            "doubt",
            ("load_z_n", "kilonewtons?"),
        ),
        "kg without sensor and mass": (
            _both(_without("force", "moment", "load_mass"), times(1 / 9.80665, *loads)),
            "doubt",
            ("load_z_n", "kilograms?"),
        ),
        "masses twice": (times(2, "load_mass_kg"), "doubt", ("load_mass_kg", "10 kg weigh 98.07 N")),
        "a mirrored joint with its torque": (
            times(-1, "q_cmd_1_rad", "q_motor_1_rad", "current_1_a"),
            "doubt",
            ("current_1_a",),
        ),
        "a force sensor at 0.7": (times(0.7, "force_z_n"), "harmless", ("force_z_n", "0.70", "channel_scale")),
        "loads twice": (times(2, *loads), "harmless", ("force_z_n", "0.50", "hung_load")),
        "a load of another step": (
            in_column(lambda v: np.where((np.arange(len(v)) == 7) & (len(v) < 50), 0.0, v), "load_z_n"),
            "harmless",
            ("force_z_n", "contradicts the loads"),
        ),
        "no column of loads": (_without("load_x", "load_y", "load_z"), "harmless", ("force_z_n", "no load is stated")),
        "currents as peaks": (
            times(2**0.5, "current_1_a", "current_2_a"),
            "harmless",
            ("current_1_a", "and so do current_2_a"),
        ),
        "a current doubled": (times(2, "current_2_a"), "harmless", ("current_2_a", "looks doubled", "channel_scale")),
        "a current halved": (times(0.5, "current_1_a"), "harmless", ("current_1_a", "looks halved", "channel_scale")),
        "a gauge doubled": (
            times(2, "gas_pressure_pa"),
            "harmless",
            ("gas_pressure_pa", "looks doubled", "channel_scale"),
        ),
        "a gauge halved": (
            times(0.5, "gas_pressure_pa"),
            "harmless",
            ("gas_pressure_pa", "looks halved", "channel_scale"),
        ),
        "starts of two ways back exchanged": (
            _in_the_wrong_order,
            "harmless",
            ("start_s", "exchanged, or not in seconds?"),
        ),
        "a current late": (in_column(late, "current_2_a"), "harmless", ("current_2_a", "looks late", "channel_delay")),
        "a tracker late": (in_column(late, *tracker), "harmless", (tracker[0], "looks late", "channel_delay")),
        "a moment of 1e6 Nm": (_added("load_mx_nm", "1e6"), "doubt", ("load_mx_nm", "the robot is rated for 50")),
        "loads in mN": (times(1e3, "load_z_n", "force_z_n"), "doubt", ("load_z_n", "the robot is rated for 300")),
        "load steps counted from the load": (
            in_column(lambda v: np.where(v < 2, 1 - v, v), "load_step"),
            "harmless",
            ("load_step", "is 0 under load"),
        ),
        "axes of a force sensor": (_exchanged("force_x_n", "force_z_n"), "doubt", ("force_x_n", "what load_z_n says")),
        "nothing": (_without("motor_temperature"), "harmless", (" 0 warnings",)),
    }
    for name, (spoil, answer, places) in found.items():
        yield Variant("cross-checks", name, spoil, answer, places)


def packets(rng: np.random.Generator) -> Iterator[Variant]:
    for of, apart in ((8, 1e-5), (20, 1e-6), (25, 1e-4)):

        def arrived(time: np.ndarray, of: int = of, apart: float = apart) -> np.ndarray:
            rows = np.arange(len(time))
            return time[rows // of * of] + rows % of * apart if np.median(np.diff(time)) > apart else time

        def spoil(folder: Path, arrived: Callable[[np.ndarray], np.ndarray] = arrived) -> None:
            for file in tables(folder):
                sheet = Sheet(file)
                if "pose" not in sheet.names and len(sheet.rows) > 100:
                    sheet.change("time_s", arrived)
                    sheet.write()

        yield Variant("packets", f"of {of}, {apart:g} s apart", spoil, "error", ("time_s", "samples came in packets"))


def _moments_elsewhere(lever: float) -> Spoil:
    def spoil(folder: Path) -> None:
        for file in tables(folder):
            sheet = Sheet(file)
            if "force_z_n" in sheet.names:
                force = np.array([float(row[sheet.names.index("force_z_n")]) for row in sheet.rows])
                sheet.change("moment_y_nm", lambda moment, force=force: moment - lever * force)
                sheet.write()

    return spoil


def set_up_elsewhere(rng: np.random.Generator) -> Iterator[Variant]:
    def moved(by: float) -> Spoil:
        return in_column(lambda z: z + by, "reflector_1_z_m")

    found: dict[str, tuple[Spoil, tuple[str, ...]]] = {
        "a force sensor that was not tared": (
            in_column(lambda z: z - 80, "force_z_n"),
            ("force_z_n", "N while no load is stated"),
        ),
        "moments about the flange": (_moments_elsewhere(0.5), ("moment_y_nm", "m beside the point")),
        "a frame 20 mm too high": (moved(0.02), ("reflector_1_x_m", "20 mm from where the model has it")),
        "a nest 60 mm too low": (moved(-0.06), ("reflector_1_x_m", "60 mm from where the model has it")),
    }
    for name, (spoil, places) in found.items():
        yield Variant("set up elsewhere", name, spoil, "harmless", places)


FAMILIES = (units, lost_samples, clocks, mistaken_channels, cross_checks, packets, set_up_elsewhere)
