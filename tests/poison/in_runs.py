"""Channels and clocks that are wrong in one run alone, ahead of the encoders, or without sign."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from tests.poison.in_channels import OTHER
from tests.poison.variant import Answer, Sheet, Spoil, Variant, in_column


def _in_run(name: str, spoil: Callable[[Sheet], None]) -> Spoil:
    def of_folder(folder: Path) -> None:
        sheet = Sheet(folder / "runs" / name)
        spoil(sheet)
        sheet.write()

    return of_folder


def one_run_of_its_own(rng: np.random.Generator) -> Iterator[Variant]:
    """One run of which a channel or the clock is not what it is in all others; a whole recording hides that."""

    def changed(column: str, change: Callable[[np.ndarray], np.ndarray]) -> Spoil:
        return _in_run(OTHER, lambda sheet: sheet.change(column, change))

    def swapped(sheet: Sheet) -> None:
        i, j = (sheet.names.index(f"current_{drive}_a") for drive in (1, 2))
        for row in sheet.rows:
            row[i], row[j] = row[j], row[i]

    run = OTHER.removesuffix(".csv")
    found: dict[str, tuple[Spoil, Answer, tuple[str, ...]]] = {
        "a clock 15 % fast": (changed("time_s", lambda t: 1.15 * t), "harmless", ("time_s", "1.15 seconds", run)),
        "a clock that counts 0.6 s": (changed("time_s", lambda t: 0.6 * t), "harmless", ("time_s", "0.60 sec", run)),
        "a current doubled": (changed("current_1_a", lambda v: 2 * v), "harmless", ("current_1_a", "times", run)),
        "a current off by 2 A": (changed("current_1_a", lambda v: v + 2), "harmless", ("current_1_a", "+2.0", run)),
        "a current turned": (changed("current_1_a", lambda v: -v), "doubt", ("current_1_a", "wrong sign", run)),
        "currents exchanged": (_in_run(OTHER, swapped), "doubt", ("current_1_a", "are exchanged", run)),
    }
    for name, (spoil, answer, places) in found.items():
        yield Variant("one run of its own", name, spoil, answer, places)


def motions_of_few_rows(rng: np.random.Generator) -> Iterator[Variant]:
    """Leave a few rows of a motion, which tell no speed."""
    for count, words in ((1, "has 1 row"), (2, "has 2 rows"), (4, "has 4 rows")):

        def cut(sheet: Sheet, count: int = count) -> None:
            sheet.rows = sheet.rows[:count]

        places = (OTHER, f"{words}: too few to tell a speed")
        yield Variant("motions of few rows", words, _in_run(OTHER, cut), "harmless", places)

    def every(folder: Path) -> None:
        for file in folder.glob("runs/*joint*.csv"):
            file.write_text("".join(file.read_text().splitlines(keepends=True)[:2]))

    place = ("too few to tell a speed",)
    yield Variant("motions of few rows", "a row of each", every, "harmless", place)
    first_pass = ("identify", ".", "--method", "dynamics")
    yield Variant("motions of few rows", "a row of each, fitted", every, "error", place, first_pass)


def one_more_number_in_one_run(rng: np.random.Generator) -> Iterator[Variant]:
    """One run of which an instrument, an angle or a load is not what all else makes of it."""
    run, loaded = OTHER.removesuffix(".csv"), "loaded-out"
    places = [f"reflector_1_{axis}_m" for axis in "xyz"]

    def changed(name: str, columns: Sequence[str], change: Callable[[np.ndarray], np.ndarray]) -> Spoil:
        def spoil(sheet: Sheet) -> None:
            for column in columns:
                sheet.change(column, change)

        return _in_run(f"{name}.csv", spoil)

    def late(values: np.ndarray) -> np.ndarray:
        return np.concatenate([np.full(5, values[0]), values[:-5]])

    load = ["load_mass_kg", "load_z_n"]
    found: dict[str, tuple[Spoil, tuple[str, ...]]] = {
        "a gauge 10 % high": (
            changed(run, ["gas_pressure_pa"], lambda p: 1.1 * p),
            ("gas_pressure_pa", "e+05 Pa", run),
        ),
        "a gauge 3 bar off": (
            changed(run, ["gas_pressure_pa"], lambda p: p + 3e5),
            ("gas_pressure_pa", "e+05 Pa", run),
        ),
        "a tracker 5 mm off": (changed(run, places[2:], lambda z: z + 0.005), (places[2], "+0.00", "m beside", run)),
        "a tracker that scales": (changed(run, places, lambda x: 1.01 * x), ("reflector_1", "1.01 times", run)),
        "a tracker late": (changed(loaded, places, late), ("reflector_1", loaded)),
        "an encoder 1 degree off": (
            changed(run, ["q_motor_1_rad"], lambda q: q + 0.0175),
            ("q_motor_1", "+0.017", run),
        ),
        "another encoder off": (changed(run, ["q_motor_2_rad"], lambda q: q + 0.0175), ("q_motor_2", "+0.017", run)),
        "half of a mass": (changed(run, load, lambda m: m / 2), ("load_mass_kg", "times the load that", run)),
        "a current late": (changed(run, ["current_1_a"], late), ("current_1_a", "all else", run)),
    }
    for name, (spoil, words) in found.items():
        yield Variant("one more number in one run", name, spoil, "harmless", words)


def payloads_that_are_known(rng: np.random.Generator) -> Iterator[Variant]:
    """Payloads that the lab knows besides, by far more than any drive paid for; currents are not to be blamed."""

    def known(kg: float) -> Spoil:
        def spoil(folder: Path) -> None:
            file = folder / "campaign.yaml"
            stated = f"known:\n- {{quantity: payload_kg, value: {kg}, sigma: 1}}\n"
            file.write_text(file.read_text() + stated)

        return spoil

    for kg in (100, 300):
        words = ("known", f"payload_kg is {kg}", "no drive paid for")
        yield Variant("payloads that are known", f"{kg} kg", known(kg), "doubt", words)


def early_and_absolute(rng: np.random.Generator) -> Iterator[Variant]:
    """Channels ahead of the encoders, and drives whose logger keeps no sign."""

    def early(values: np.ndarray) -> np.ndarray:
        return values if len(values) < 50 else np.concatenate([values[5:], np.full(5, values[-1])])

    def late(values: np.ndarray) -> np.ndarray:
        return values if len(values) < 50 else np.concatenate([np.full(5, values[0]), values[:-5]])

    for drive in (1, 2):
        name = f"current_{drive}_a"
        yield Variant("early and absolute", f"{name} early", in_column(early, name), "harmless", (name, "looks early"))
        words = (name, "is nowhere negative", "an absolute value?")
        yield Variant("early and absolute", f"{name} without sign", in_column(np.abs, name), "doubt", words)
    for how, shift in (("early", early), ("late", late)):
        words = ("gas_pressure_pa", f"looks {how}", "channel_delay")
        spoil = in_column(shift, "gas_pressure_pa")
        yield Variant("early and absolute", f"a gauge {how}", spoil, "harmless", words)


FAMILIES = (
    motions_of_few_rows,
    one_run_of_its_own,
    one_more_number_in_one_run,
    payloads_that_are_known,
    early_and_absolute,
)
