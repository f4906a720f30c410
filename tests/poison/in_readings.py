"""Readings that were lost, copied or spoilt, and things known besides that the robot cannot have."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.poison.in_tables import MOTION
from tests.poison.variant import Answer, Sheet, Spoil, Variant, tables


def _cell(column: str, value: float, rows: tuple[int, ...]) -> Spoil:
    def spoil(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / MOTION)
        for row in rows:
            sheet.set(row, column, repr(value))
        sheet.write()

    return spoil


def spoilt_readings(rng: np.random.Generator) -> Iterator[Variant]:
    row = int(rng.integers(15, 25))
    alone: dict[str, tuple[float, Answer, tuple[str, ...]]] = {
        "current_2_a": (200.0, "harmless", ("current_2_a", "lost or spoilt?")),
        "reflector_1_x_m": (9.0, "harmless", ("reflector_1_x_m", "lost or spoilt?")),
        "gas_pressure_pa": (-1e9, "error", ("gas_pressure_pa", "vacuum")),
        "load_mass_kg": (-1.0, "error", ("load_mass_kg", "is no mass")),
        "load_z_n": (-1e9, "error", ("load_z_n", "over 1e+06")),
    }
    for column, (value, answer, words) in alone.items():
        yield Variant("spoilt readings", f"{column} in row {row}", _cell(column, value, (row,)), answer, words)


def copied_runs(rng: np.random.Generator) -> Iterator[Variant]:
    def over(kind: str, link: bool) -> Spoil:
        def spoil(folder: Path) -> None:
            alike = [file for file in tables(folder) if ("pose" in Sheet(file).names) == (kind == "static")]
            alike[1].unlink()
            if link:
                alike[1].symlink_to(alike[0].name)
            else:
                shutil.copy(alike[0], alike[1])

        return spoil

    for link in (False, True):
        name = "a link to another run" if link else "a copy of another run"
        yield Variant("copied runs", name, over("motion", link), "doubt", ("holds the same readings as",))


def known_of_no_such_robot(rng: np.random.Generator) -> Iterator[Variant]:
    entries = {
        "joint 9": ("{quantity: stiffness_nm_per_rad, joint: 9, value: 1.0e6, sigma: 1.0e5}", "known[0].joint"),
        "too few angles": ("{quantity: gas_pressure_pa, at: [0.0], value: 1.0e7, sigma: 1.0e5}", "known[0].at"),
        "degrees": ("{quantity: gas_pressure_pa, at: [0.0, -90.0], value: 1.0e7, sigma: 1.0e5}", "known[0].at"),
        "a sigma of nothing": ("{quantity: payload_kg, value: 1, sigma: 1.0e-300}", "known[0].sigma"),
    }
    for name, (entry, place) in entries.items():

        def spoil(folder: Path, entry: str = entry) -> None:
            file = folder / "campaign.yaml"
            file.write_text(f"{file.read_text()}known: [{entry}]\n")

        yield Variant("known of no such robot", name, spoil, "error", ("campaign.yaml", place))


FAMILIES = (spoilt_readings, copied_runs, known_of_no_such_robot)
