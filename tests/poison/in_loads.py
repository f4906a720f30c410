"""What nobody wrote down, or in another unit: loads, noise, temperatures; and single places, unseen characters."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from tests.poison.in_tables import MOTION
from tests.poison.variant import Sheet, Variant, tables

LOADS = ("load_x_n", "load_y_n", "load_z_n")
MEASURED = ("current", "tau_motor", "reflector", "force", "moment", "gas_pressure")


def loads_that_were_forgotten(rng: np.random.Generator) -> Iterator[Variant]:
    """Write 0 where a load hung, or one load for all, and leave no force sensor that says so."""

    def spoil(folder: Path, runs: str, without: tuple[str, ...], load: str) -> None:
        for sheet in map(Sheet, tables(folder)):
            if "pose" in sheet.names and sheet.file.name.startswith(runs):
                for column in LOADS:
                    for row in range(1, len(sheet.rows) + 1):
                        sheet.set(row, column, load if column == "load_z_n" else "0")
            kept = [i for i, name in enumerate(sheet.names) if not name.startswith(without)]
            sheet.names, sheet.rows = [sheet.names[i] for i in kept], [[row[i] for i in kept] for row in sheet.rows]
            sheet.write()

    unfelt = ("force_", "moment_")
    found = {
        "in every run": ("", unfelt, "0", "reflector_1"),
        "in one run": ("pose1-from-below", unfelt, "0", "pose1-from-below"),
        "one load for all": ("", unfelt, "-250", "reflector_1"),
    }
    for name, (runs, without, load, word) in found.items():
        words = ("load_z_n", word, "no load is stated to change")
        change = partial(spoil, runs=runs, without=without, load=load)
        yield Variant("loads that were forgotten", name, change, "doubt", words)


def loads_that_their_sensor_repeats(rng: np.random.Generator) -> Iterator[Variant]:
    """Double what is written of a load together with the force sensor; all other instruments know better."""

    def spoil(folder: Path, run: str) -> None:
        sheet = Sheet(folder / "runs" / f"{run}.csv")
        for column in (*LOADS, "force_x_n", "force_y_n", "force_z_n"):
            if column in sheet.names:
                sheet.change(column, lambda values: 2 * values)
        sheet.write()

    for run in ("loaded-out", "loaded-back"):
        words = ("load_z_n and force", f"times the load that instruments show in run '{run}'")
        yield Variant("loads that their sensor repeats", run, partial(spoil, run=run), "harmless", words)


def noise_in_another_unit(rng: np.random.Generator) -> Iterator[Variant]:
    def state(folder: Path, entry: str) -> None:
        file = folder / "campaign.yaml"
        file.write_text(f"{file.read_text()}noise: {{{entry}}}\n")

    for entry, words in {
        "current: 30": "times as much as its readings scatter",
        "reflector: 0.03": "times as much as its readings scatter",
        "force: 500": "times as much as its readings scatter",
        "current: 2.0e-5": "times less than any of its readings scatter",
        "force: 5.0e-4": "times less than any of its readings scatter",
    }.items():
        places = (f"noise.{entry.split(':')[0]}", words)
        yield Variant("noise in another unit", entry, partial(state, entry=entry), "harmless", places)


def known_beside_a_thermometer(rng: np.random.Generator) -> Iterator[Variant]:
    def spoil(folder: Path, known: float, logged: float) -> None:
        for sheet in map(Sheet, tables(folder)):
            sheet.names.append("gas_temperature_k")
            sheet.rows = [[*row, repr(logged)] for row in sheet.rows]
            sheet.write()
        file = folder / "campaign.yaml"
        entry = f"{{quantity: gas_temperature_k, value: {known}, sigma: 1}}"
        file.write_text(f"{file.read_text()}known: [{entry}]\n")

    for known, logged in ((333.0, 293.0), (273.0, 293.0)):
        words = ("known[0].value", f"gas_temperature_k is {logged:g}")
        change = partial(spoil, known=known, logged=logged)
        yield Variant("known beside a thermometer", f"{known:g} K", change, "harmless", words)


def places_out_of_line(rng: np.random.Generator) -> Iterator[Variant]:
    row = int(rng.integers(12, 20))

    def spoil(folder: Path, column: str, off: float) -> None:
        sheet = Sheet(folder / "runs" / MOTION)
        sheet.set(row, column, repr(float(sheet.rows[row - 1][sheet.names.index(column)]) + off))
        sheet.write()

    for column, off in (("reflector_1_x_m", 0.003), ("reflector_1_z_m", 0.005), ("reflector_1_z_m", -0.02)):
        words = ("reflector_1", f"row {row}", "mm out of the line")
        change = partial(spoil, column=column, off=off)
        yield Variant("places out of line", f"{column} {off:g} m off in a motion", change, "harmless", words)


def rows_at_rest_in_another_order(rng: np.random.Generator) -> Iterator[Variant]:
    """Give readings at rest the rows of others, or repeats the numbers of the first."""
    places = tuple(f"reflector_1_{axis}_m" for axis in "xyz")

    def spoil(folder: Path, order: str) -> None:
        for sheet in map(Sheet, tables(folder)):
            if "pose" not in sheet.names:
                continue
            rows = list(range(len(sheet.rows)))
            repeat = [int(float(row[sheet.names.index("repeat")])) for row in sheet.rows]
            taken = {
                "late": [max(row - 1, 0) for row in rows],
                "shuffled": rng.permutation(rows).tolist(),
                "copied": [row + 1 - repeat[row] for row in rows],
            }[order]
            own = places if order != "copied" else [n for n in sheet.names if n.startswith(MEASURED)]
            old = [list(row) for row in sheet.rows]
            for row, other in zip(rows, taken, strict=True):
                for name in own:
                    sheet.set(row + 1, name, old[other][sheet.names.index(name)])
            sheet.write()

    for order, answer, words in (
        ("late", "doubt", ("reflector_1", "joined to")),
        ("shuffled", "doubt", ("reflector_1", "not with them")),
        ("copied", "harmless", ("repeat", "to the last digit in all channels")),
    ):
        yield Variant("rows at rest in another order", order, partial(spoil, order=order), answer, words)


def unseen_characters(rng: np.random.Generator) -> Iterator[Variant]:
    def spoil(folder: Path, column: str, unseen: str) -> None:
        file = folder / "runs" / MOTION
        file.write_text(file.read_text().replace(column, column[:3] + unseen + column[3:], 1), encoding="utf-8")

    for name, unseen in {"a byte order mark": "\ufeff", "a zero width space": "\u200b", "a hard space": "\xa0"}.items():
        for column in ("current_1_a", "reflector_1_x_m", "time_s"):
            words = (MOTION, column, f"has U+{ord(unseen):04X} in it")
            change = partial(spoil, column=column, unseen=unseen)
            yield Variant("unseen characters", f"{name} in {column}", change, "error", words)


FAMILIES = (
    loads_that_were_forgotten,
    loads_that_their_sensor_repeats,
    noise_in_another_unit,
    known_beside_a_thermometer,
    places_out_of_line,
    rows_at_rest_in_another_order,
    unseen_characters,
)
