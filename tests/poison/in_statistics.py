"""Channels of the right mean and size that tell of another movement than the one that was made."""

from collections.abc import Iterator

import numpy as np

from tests.poison.variant import Answer, Sheet, Spoil, Variant, in_tables

AT_REST = 50  # rows; shorter runs are readings at rest


def _in_motions(column: str, change: str) -> Spoil:
    def changed(sheet: Sheet) -> None:
        if len(sheet.rows) <= AT_REST:
            return
        rng = np.random.default_rng(1)
        sheet.change(
            column,
            {
                "noise": lambda v: np.mean(v) + np.std(v) * rng.standard_normal(len(v)),
                "backwards": lambda v: v[::-1],
                "squares": lambda v: v * np.abs(v),
                "half of it": lambda v: (v + v[0]) / 2,
                "steps": np.gradient,
                "one number": lambda v: 0 * v + v[0],
            }[change],
        )

    return in_tables(changed)


def drives_that_did_something_else(rng: np.random.Generator) -> Iterator[Variant]:
    """Give noise about the mean of a motion, or the motion backwards; what drives hold against weight hid it."""
    for drive in (1, 2):
        column = f"current_{drive}_a"
        for change in ("noise", "backwards"):
            words = (column, "of how it changes within runs")
            yield Variant(
                "drives that did something else", f"{column}: {change}", _in_motions(column, change), "harmless", words
            )


def angles_of_another_movement(rng: np.random.Generator) -> Iterator[Variant]:
    """Give angles that miss their commands by a third of the movement, and commands that stand still."""
    for column, change in (
        *(("q_cmd_1_rad", "squares"), ("q_cmd_1_rad", "half of it"), ("q_cmd_2_rad", "half of it")),
        *(("q_cmd_1_rad", "one number"), ("q_cmd_1_rad", "steps")),
    ):
        words = (column, f"{column.replace('cmd', 'motor')}: does not follow {column}")
        yield Variant(
            "angles of another movement", f"{column}: {change}", _in_motions(column, change), "harmless", words
        )


def copies_of_other_instruments(rng: np.random.Generator) -> Iterator[Variant]:
    """Write one column over another of another instrument, to the last digit."""
    copies: tuple[tuple[str, str, Answer], ...] = (
        ("load_z_n", "force_z_n", "doubt"),
        ("reflector_1_x_m", "reflector_1_y_m", "doubt"),
        ("gear_temperature_1_k", "gear_temperature_2_k", "harmless"),
        ("motor_temperature_1_k", "gear_temperature_1_k", "harmless"),
        ("ambient_temperature_k", "gear_temperature_1_k", "harmless"),
    )
    for source, column, answer in copies:

        def copied(sheet: Sheet, source: str = source, column: str = column) -> None:
            if {source, column} <= set(sheet.names):
                own = np.array([float(row[sheet.names.index(source)]) for row in sheet.rows])
                sheet.change(column, lambda values: own)

        words = ("is a copy of", source, column)
        yield Variant("copies of other instruments", f"{column} of {source}", in_tables(copied), answer, words)


FAMILIES = (drives_that_did_something_else, angles_of_another_movement, copies_of_other_instruments)
