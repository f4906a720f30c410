"""Values of the wrong type in `log.yaml`, in what is known besides and in JSON that is handed on; empty arguments."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from tests.poison.in_results import APPLY, COMMANDS, FOUND, PREDICT
from tests.poison.in_scenarios import CONVERT, LOG, ROWS
from tests.poison.variant import Spoil, Variant

MANIFEST = "campaign.yaml"


def _log(text: str, rows: str = ROWS) -> Spoil:
    def spoil(folder: Path) -> None:
        (folder / "robot" / "log.yaml").write_text(text)
        (folder / "log.csv").write_text(rows)

    return spoil


def types_in_a_log_yaml(rng: np.random.Generator) -> Iterator[Variant]:
    angle, clock = "{from: q}", "{from: t}"
    faults = {
        **{
            f"from: {value}": LOG.replace(angle, f"{{from: {value}}}")
            for value in ("0", "-1", "1.5", "true", "[q]", "''")
        },
        **{
            f"{key} of a column": LOG.replace(angle, f"{{from: q, {key}}}")
            for key in ("fill: spline", "optional: maybe")
        },
        "a table of no such name": LOG.replace(angle, "{from: q, table: nowhere}"),
        **{f"{value} rows a second": LOG.replace(clock, f"{{rate_hz: {value}}}") for value in ("0", "-1", ".nan")},
        "a clock twice": LOG.replace(clock, "{from: t, rate_hz: 50}"),
        "an offset of nan": LOG.replace(angle, "{from: q, offset: .nan}"),
        **{
            f"table: {entry}": f"{LOG}table: {{{entry}}}\n"
            for entry in ('separator: ""', "separator: ',,'", "decimal: ':'", "header: perhaps", "skip_lines: -1")
        },
        **{
            f"runs: {entry}": f"{LOG}runs: {{{entry}}}\n"
            for entry in (
                *("windows_s: [[2, 1]]", "windows_s: [[1, 1]]", "windows_s: [[.nan, 1]]", "windows_s: [0, 1]"),
                *("windows_s: [[a, b]]", "split_at_s: [.nan]", "split_at_s: 1", "split_at_rest_s: 0"),
                "split_at_rest_s: -1",
            )
        },
        **{f"resample: {entry}": f"{LOG}resample: {entry}\n" for entry in ("{rate_hz: 0}", "{rate_hz: -5}", "fast")},
        **{f"noise: {entry}": f"{LOG}noise: {{{entry}}}\n" for entry in ("voltage: 1", "current: -1")},
        "columns as a list": "columns: [a, b]\n",
        "no columns in it": "columns: {}\n",
    }
    for name, text in faults.items():
        yield Variant("types in a log.yaml", name, _log(text), "error", ("log.yaml",), CONVERT)


def readings_beyond_all_numbers(rng: np.random.Generator) -> Iterator[Variant]:
    """Give readings that are no number any more once they are multiplied; Python warned of an overflow."""
    text = LOG.replace("{from: q}", "{from: q, factor: -160.0}")
    for value in ("1e307", "-1.7e308"):
        spoil = _log(text, ROWS.replace("0.1,0.2,", f"0.1,{value},"))
        yield Variant("readings beyond all numbers", value, spoil, "error", ("log.csv", "row 2", "q"), CONVERT)


def types_of_what_is_known(rng: np.random.Generator) -> Iterator[Variant]:
    payload, stiff = "quantity: payload_kg, value: 5", "quantity: stiffness_nm_per_rad, sigma: 1.0e+4"
    entries = {
        **{
            f"payload, {key}": (f"{payload}, {key}", "known[0]")
            for key in ("sigma: 0", "sigma: -1", "sigma: .inf", "sigma: 1, joint: 1", "sigma: 1, unit: kg")
        },
        **{
            f"payload of {value}": (f"quantity: payload_kg, sigma: 1, value: {value}", "known[0]")
            for value in ("-5", "true", "[5]")
        },
        **{
            f"joint {joint}": (f"{stiff}, value: 2.0e+5, joint: {joint}", "known[0].joint")
            for joint in ("0", "1.5", "hinge_a")
        },
        "a payload in a pose": (f"{payload}, sigma: 1, at: [0, 0]", "known[0]"),
        "no joint": (f"{stiff}, value: 2.0e+5", "joint"),
        "no sigma": (payload, "sigma"),
        "a recording that is none": (f"{payload}, sigma: 1, recording: june", "known[0].recording"),
        "words for a pose": ("quantity: gas_pressure_pa, value: 3.0e+6, sigma: 1.0e+5, at: [a, b]", "known[0].at"),
        "an unknown quantity": ("quantity: mass, value: 1, sigma: 1", "known[0].quantity"),
    }
    for name, (entry, place) in entries.items():

        def append(folder: Path, entry: str = entry) -> None:
            file = folder / MANIFEST
            file.write_text(f"{file.read_text()}known: [{{{entry}}}]\n")

        yield Variant("types of what is known", name, append, "error", (MANIFEST, place))


def bytes_of_what_is_handed_on(rng: np.random.Generator) -> Iterator[Variant]:
    number = rb"-?\d+\.\d+"
    changes: dict[str, Callable[[bytes], bytes]] = {
        "a mark": lambda data: b"\xef\xbb\xbf" + data,
        "UTF-16": lambda data: data.decode().encode("utf-16"),
        "a zero byte": lambda data: data[:50] + b"\0" + data[50:],
        "something behind": lambda data: data + b" {}",
        **{
            f"a number {word}": lambda data, word=word: re.sub(number, word.encode(), data, count=1)
            for word in ("NaN", "-Infinity", "1e999")
        },
        "a number of 6000 digits": lambda data: re.sub(number, b"9" * 6000, data, count=1),
        "60 MB of blanks": lambda data: data + b" " * 60_000_000,
    }
    for file, command in COMMANDS.items():
        for name, change in changes.items():

            def spoil(folder: Path, file: str = file, change: Callable[[bytes], bytes] = change) -> None:
                path = folder / FOUND / "robot" / file
                path.write_bytes(change(path.read_bytes()))

            yield Variant("bytes of what is handed on", f"{file}: {name}", spoil, "error", (file,), command)


def empty_arguments(rng: np.random.Generator) -> Iterator[Variant]:
    """Give what a variable of the shell leaves that is not set; it was the folder here."""
    for name, command in {
        "a campaign to check": ("check", ""),
        "a robot that predicts": (PREDICT[0], "", "."),
        "a robot to apply": (APPLY[0], "", *APPLY[2:]),
        "a place to write to": ("predict", FOUND, ".", "-o", ""),
    }.items():
        yield Variant("empty arguments", name, lambda folder: None, "error", ("an empty argument",), command)


FAMILIES = (
    types_in_a_log_yaml,
    readings_beyond_all_numbers,
    types_of_what_is_known,
    bytes_of_what_is_handed_on,
    empty_arguments,
)
