"""Channels that stop, are cut off, held or shifted within their runs, and units that change in the middle of one."""

from collections.abc import Callable, Iterator

import numpy as np

from tests.poison.in_tables import MOTION
from tests.poison.variant import Answer, Sheet, Spoil, Variant, in_tables

Change = Callable[[np.ndarray], np.ndarray]
RUN = MOTION.removesuffix(".csv")
PLACES = tuple(f"reflector_1_{axis}_m" for axis in "xyz")
AT_REST = 50  # rows; shorter runs are readings at rest


def _in_motions(change: Change, *columns: str, table: str = "*.csv") -> Spoil:
    def changed(sheet: Sheet) -> None:
        for column in columns:
            if column in sheet.names and len(sheet.rows) > AT_REST:
                sheet.change(column, change)

    return in_tables(changed, table)


def _cut(values: np.ndarray) -> np.ndarray:
    return np.clip(values, *np.quantile(values, (0.2, 0.8)))


def _rests(values: np.ndarray) -> np.ndarray:
    rows = np.arange(len(values)) / len(values)
    return np.where((rows > 0.3) & (rows < 0.6), values[int(0.3 * len(values))], values)


def channels_that_stop(rng: np.random.Generator) -> Iterator[Variant]:
    """Cut channels off at either end, or let them repeat one reading for a third of each motion."""
    for name, change, columns in (
        ("cut off", _cut, ("reflector_1_x_m", "reflector_1_z_m", "q_motor_1_rad")),
        ("resting", _rests, ("reflector_1_x_m", "reflector_1_z_m", "q_motor_1_rad", "current_1_a", "current_2_a")),
    ):
        for column in columns:
            spoil, words = _in_motions(change, column), column.removesuffix("_rad")
            yield Variant("channels that stop", f"{column} {name}", spoil, "doubt", (words,))


def channels_that_are_held(rng: np.random.Generator) -> Iterator[Variant]:
    """Let a channel of each motion repeat its last reading for ten or 25 rows: it is late."""
    for count in (10, 25):
        for column in ("q_motor_1_rad", "reflector_1_x_m"):

            def hold(values: np.ndarray, count: int = count) -> np.ndarray:
                return values[np.arange(len(values)) // count * count]

            answer: Answer = "doubt" if column.startswith("q_") else "error or harmless"
            yield Variant(
                "channels that are held", f"{column} for {count}", _in_motions(hold, column), answer, (column,)
            )


def channels_that_are_shifted(rng: np.random.Generator) -> Iterator[Variant]:
    """Shift a channel of each motion by a quarter of it."""

    def roll(values: np.ndarray) -> np.ndarray:
        return np.roll(values, len(values) // 4)

    for column in ("q_motor_1_rad", "reflector_1_x_m", "current_1_a"):
        words = (column.removesuffix("_rad"),)
        yield Variant("channels that are shifted", column, _in_motions(roll, column), "error or harmless", words)


def units_that_change_within_a_run(rng: np.random.Generator) -> Iterator[Variant]:
    found: dict[str, tuple[str, Change, Answer]] = {
        "degrees": ("q_motor_1_rad", lambda v: 57.29578 * v, "error or harmless"),
        "milliamperes": ("current_2_a", lambda v: 1000 * v, "error or harmless"),
        "millimetres": ("reflector_1_x_m", lambda v: 1000 * v, "error"),
        "bar": ("gas_pressure_pa", lambda v: v / 1e5, "error or harmless"),
        "degrees Celsius": ("ambient_temperature_k", lambda v: v - 273.15, "error"),
        "kilonewtons": ("load_z_n", lambda v: v / 1000, "error or harmless"),
    }
    for name, (column, change, answer) in found.items():
        for share in (0.5, 0.9):

            def late(values: np.ndarray, change: Change = change, share: float = share) -> np.ndarray:
                return np.where(np.arange(len(values)) >= share * len(values), change(values), values)

            spoil = _in_motions(late, column, table=MOTION)
            words = (column.removesuffix("_rad"), RUN)
            yield Variant("units that change within a run", f"{name} from {share:.0%} on", spoil, answer, words)


def clocks_that_change_their_pace(rng: np.random.Generator) -> Iterator[Variant]:
    for name, pace in (("twice as fast", 2.0), ("half as fast", 0.5)):

        def paced(time: np.ndarray, pace: float = pace) -> np.ndarray:
            middle = time[len(time) // 2]
            return np.where(time > middle, middle + pace * (time - middle), time)

        spoil = _in_motions(paced, "time_s", table=MOTION)
        yield Variant("clocks that change their pace", name, spoil, "error or harmless", ("time_s", RUN))


def angles_of_something_else(rng: np.random.Generator) -> Iterator[Variant]:
    """Give speeds for commands, the servo's error for an angle, or angles with another zero than their commands."""

    def speeds(sheet: Sheet) -> None:
        if len(sheet.rows) > AT_REST:
            sheet.change("q_cmd_1_rad", lambda values: np.gradient(values, 0.02))

    def error(sheet: Sheet) -> None:
        for drive in (1, 2):
            place = sheet.names.index(f"q_cmd_{drive}_rad")
            command = np.array([float(row[place]) for row in sheet.rows])
            sheet.change(f"q_motor_{drive}_rad", lambda values, command=command: values - command)

    found: dict[str, tuple[Spoil, Answer, tuple[str, ...]]] = {
        "speeds for commands": (in_tables(speeds), "harmless", ("q_motor_1_rad", "does not follow q_cmd_1_rad")),
        "the servo's error": (in_tables(error), "doubt", ("q_motor_1_rad", "q_cmd_1_rad")),
    }
    for drive in (1, 2):
        column = f"q_motor_{drive}_rad"
        zero = in_tables(lambda sheet, column=column: sheet.change(column, lambda values: values + 0.087))
        words = (column, f"rad beside q_cmd_{drive}_rad")
        found[f"another zero of drive {drive}"] = (zero, "harmless", words)
    for name, (spoil, answer, places) in found.items():
        yield Variant("angles of something else", name, spoil, answer, places)


FAMILIES = (
    channels_that_stop,
    channels_that_are_held,
    channels_that_are_shifted,
    units_that_change_within_a_run,
    clocks_that_change_their_pace,
    angles_of_something_else,
)
