"""`campaign.yaml`: keys, values, paths, YAML that explodes, and garbage."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.poison.variant import Spoil, Variant

RUN = "{name: dwell, kind: static, start_s: 0}"
HEAD = "format: 1\nrobot: robot\n"
MANIFEST = "campaign.yaml"
LAUGHS = "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10 if i else ['x'] * 10)}]\n" for i in range(12))


def _written(text: str | bytes) -> Spoil:
    data = text if isinstance(text, bytes) else text.encode()
    return lambda folder: _write(folder / MANIFEST, data)


def _write(file: Path, data: bytes) -> None:
    file.write_bytes(data)


def _of(family: str, texts: dict[str, tuple[str | bytes, tuple[str, ...]]]) -> Iterator[Variant]:
    for name, (text, places) in texts.items():
        yield Variant(family, name, _written(text), "error", (MANIFEST, *places))


def keys_of_the_manifest(rng: np.random.Generator) -> Iterator[Variant]:
    yield from _of(
        "keys of the manifest",
        {
            "no format": (f"robot: robot\nruns: [{RUN}]", ("format",)),
            "another format": (f"format: 2\nrobot: robot\nruns: [{RUN}]", ("format",)),
            "no robot": (f"format: 1\nruns: [{RUN}]", ("robot",)),
            "a robot without a value": (f"format: 1\nrobot:\nruns: [{RUN}]", ("robot",)),
            "unknown key": (f"{HEAD}robots: 3\nruns: [{RUN}]", ("robots",)),
            "key given twice": (f"{HEAD}robot: hh150\nruns: [{RUN}]", ("line 3", "twice")),
            "key of a run given twice": (
                f"{HEAD}runs: [{{name: dwell, kind: static, kind: motion, start_s: 0}}]", ("line 3", "twice")
            ),
            "no runs": (HEAD, ("runs",)),
            "runs as a mapping": (f"{HEAD}runs: {{a: 1}}", ("runs",)),
            "runs as a word": (f"{HEAD}runs: dwell", ("runs",)),
            "a run that is a list": (f"{HEAD}runs: [[dwell]]", ("runs[0]",)),
            "a list": (f"- {RUN}", ()),
            "a word": ("hello", ()),
            "nothing": ("", ()),
            "a thousand unknown keys": (HEAD + "".join(f"k{i}: 1\n" for i in range(1000)), ("k7",)),
        },
    )  # fmt: skip


def values_of_the_manifest(rng: np.random.Generator) -> Iterator[Variant]:
    faults = {
        "start_s": ("nan", ".inf", "-1", "noon", "[1]", "{a: 1}", "1e999", "9" * 5000, "0x10", "''"),
        "kind": ("moving", "1", "[static]", "STATIC"),
        "name": ("a/b", "../x", "''", "'a b'", "é", "x" * 200, "'a\\0b'", "-x"),
        "recording": ("[a]", "x" * 200, r'"a\nb"', r'"\x1b[31m"'),
    }
    for key, values in faults.items():
        for value in values:
            own = {"name": "dwell", "kind": "static", "start_s": "0"} | {key: value}
            run = ", ".join(f"{name}: {text}" for name, text in own.items())
            spoil = _written(f"{HEAD}runs: [{{{run}}}]")
            yield Variant(
                "values of the manifest", f"{key}: {value[:20]}", spoil, "error", (MANIFEST, f"runs[0].{key}")
            )
    for line in (
        "started: May",
        "started: 2024-99-99",
        "started: 2924-05-13",
        "started: 0001-01-01",
        "noise: {load: 1}",
        "noise: {current: -1}",
        "noise: {current: .nan}",
        "noise: {current: }",
        "noise: {current: null, gas_pressure: 1e4}",
        "noise: {current}",
    ):
        text = f"{HEAD}{line}\nruns: [{RUN}]"
        yield Variant("values of the manifest", line, _written(text), "error", (MANIFEST, line.split(":")[0]))


def known_besides(rng: np.random.Generator) -> Iterator[Variant]:
    """List as known what nobody can have read."""
    pressure = "quantity: gas_pressure_pa, value: 7e6"
    faults = {
        "a pressure to a millionth of a millionth": (f"{pressure}, sigma: 1e-6, at: [0, 0]", "known[0].sigma"),
        "a stiffness of 1e12": ("quantity: stiffness_nm_per_rad, joint: 1, value: 1e12, sigma: 1e9", "known[0].value"),
        "a stiffness of joint 9": ("quantity: stiffness_nm_per_rad, joint: 9, value: 1e5, sigma: 1", "known[0].joint"),
        "a pressure outside of the joint": (f"{pressure}, sigma: 1e5, at: [50, 0]", "known[0].at"),
        "a pressure of half a pose": (f"{pressure}, sigma: 1e5, at: [0]", "known[0].at"),
        "a payload of nan": ("quantity: payload_kg, value: .nan, sigma: 1", "known[0].value"),
        "a payload of 1e9": ("quantity: payload_kg, value: 1e9, sigma: 1", "known[0].value"),
    }
    for name, (entry, place) in faults.items():

        def append(folder: Path, entry: str = entry) -> None:
            file = folder / MANIFEST
            file.write_text(f"{file.read_text()}known: [{{{entry}}}]\n")

        yield Variant("known besides", name, append, "error", (MANIFEST, place))


def paths_of_tables(rng: np.random.Generator) -> Iterator[Variant]:
    paths = (
        *("../x.csv", "/etc/passwd", "/etc/hostname.csv", "runs/../../x.csv", "x" * 5000 + ".csv", "runs"),
        *(
            "campaign.yaml",
            "robot/small.xml",
            "a\0b.csv",
            "\\ud800.csv",
            "nowhere.csv",
            "runs/dwell.csv/x.csv",
            "~/x.csv",
        ),
    )
    for path in paths:
        quoted = path.replace("\0", "\\0")
        text = f'{HEAD}runs: [{{name: dwell, kind: static, start_s: 0, file: "{quoted}"}}]'
        place = (MANIFEST,) if path not in ("nowhere.csv", "runs/dwell.csv/x.csv", "~/x.csv") else (path,)
        place = () if len(path) > 1000 else place
        yield Variant("paths of tables", repr(path[:30]), _written(text), "error", place)
    twice = f"{HEAD}runs: [{RUN}, {{name: other, kind: static, start_s: 0, file: runs/dwell.csv}}]"
    yield Variant("paths of tables", "one table for two runs", _written(twice), "error", (MANIFEST, "other"))
    yield Variant(
        "paths of tables", "two runs of one name", _written(f"{HEAD}runs: [{RUN}, {RUN}]"), "error", ("dwell",)
    )


def yaml_that_explodes(rng: np.random.Generator) -> Iterator[Variant]:
    yield from _of(
        "YAML that explodes",
        {
            "a thousand million laughs": (LAUGHS, ("BENCH_MOST_YAML_VALUES",)),
            "50 000 brackets": (f"{HEAD}runs: {'[' * 50_000}", ("BENCH_MOST_YAML_DEPTH",)),
            "50 000 braces": ("{a: " * 50_000, ("BENCH_MOST_YAML_DEPTH",)),
            "deep by indentation": ("".join(f"{' ' * i}a:\n" for i in range(1200)), ("BENCH_MOST_YAML_DEPTH",)),
            "lists in lists": ("- " * 50_000, ("BENCH_MOST_YAML_DEPTH",)),
            "an alias in itself": (f"{HEAD}runs: &a [*a]", ("line 3",)),
            "an alias to nothing": (f"{HEAD}runs: *a", ("line 3",)),
            "600 000 empty lists": (f"{HEAD}runs: [{'[],' * 600_000}]", ("BENCH_MOST_YAML_VALUES",)),
            "ten megabytes": (f"{HEAD}notes: {'x ' * 5_000_000}\nruns: [{RUN}]", ("BENCH_MOST_YAML_BYTES",)),
            "six thousand runs": (
                HEAD + "runs:\n" + "".join(f"- {{name: r{i}, kind: static, start_s: 0}}\n" for i in range(6000)),
                ("BENCH_MOST_CAMPAIGN_RUNS",),
            ),
            "100 000 question marks": ("? " * 100_000, ()),
            "an endless scalar": (f'{HEAD}notes: "{"x" * 100_000}', ()),
        },
    )


def garbage_for_a_manifest(rng: np.random.Generator) -> Iterator[Variant]:
    yield from _of(
        "garbage for a manifest",
        {
            "random bytes": (rng.bytes(3000), ()),
            "zeros": (b"\0" * 3000, ()),
            "latin-1": ("robot: Knickarm Größe".encode("latin-1"), ("UTF-8",)),
            "UTF-16": ((HEAD + f"runs: [{RUN}]").encode("utf-16"), ()),
            "tabs": ("format: 1\n\trobot: x", ("line 2",)),
            "code": (f"{HEAD}notes: !!python/object/apply:os.system [id]\nruns: 7", ("line 3", "!!python")),
            "a type of somebody's own": (f"{HEAD}notes: !x y\nruns: [{RUN}]", ("line 3", "!x")),
            "a set": (f"{HEAD}noise: !!set {{current}}\nruns: [{RUN}]", ("line 3", "!!set")),
            "bytes": (f"{HEAD}notes: !!binary aGVsbG8=\nruns: [{RUN}]", ("line 3", "!!binary")),
            "a number that is none": (f"{HEAD}notes: !!int noon\nruns: [{RUN}]", ("line 3", "!!int")),
            "two documents": (f"{HEAD}---\n{HEAD}", ("line 3",)),
            "half a pair": (f'{HEAD}notes: "\\ud800"\nruns: [{RUN}]', ("line 3",)),
            "a key that is a list": ("? [a]\n: 1", ("line 1",)),
            "JSON cut": ('{"format": 1, "runs": [', ()),
            "a percent": ("%", ()),
        },
    )


FAMILIES = (
    keys_of_the_manifest,
    values_of_the_manifest,
    known_besides,
    paths_of_tables,
    yaml_that_explodes,
    garbage_for_a_manifest,
)
