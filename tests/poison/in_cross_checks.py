"""Tables whose channels contradict each other or the model, or are right about something that was set up elsewhere."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import yaml

from tests.poison.variant import Answer, Sheet, Spoil, Variant, exchanged, in_column, in_tables


def _without(*prefixes: str) -> Spoil:
    """Return what takes columns out of every table."""

    def take_out(sheet: Sheet) -> None:
        kept = [i for i, name in enumerate(sheet.names) if not name.startswith(prefixes)]
        sheet.names = [sheet.names[i] for i in kept]
        sheet.rows = [[row[i] for i in kept] for row in sheet.rows]

    return in_tables(take_out)


def _added(name: str, cell: str) -> Spoil:
    """Return what adds a column to every table."""

    def add(sheet: Sheet) -> None:
        sheet.names.append(name)
        sheet.rows = [[*row, cell] for row in sheet.rows]

    return in_tables(add)


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
        "axes of a force sensor": (exchanged("force_x_n", "force_z_n"), "doubt", ("force_x_n", "what load_z_n says")),
        "nothing": (_without("motor_temperature"), "harmless", (" 0 warnings",)),
    }
    for name, (spoil, answer, places) in found.items():
        yield Variant("cross-checks", name, spoil, answer, places)


def _moments_elsewhere(lever: float) -> Spoil:
    def turn(sheet: Sheet) -> None:
        if "force_z_n" in sheet.names:
            force = np.array([float(row[sheet.names.index("force_z_n")]) for row in sheet.rows])
            sheet.change("moment_y_nm", lambda moment: moment - lever * force)

    return in_tables(turn)


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


FAMILIES = (cross_checks, set_up_elsewhere)
