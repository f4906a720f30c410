"""How much of a stranger's file is read: more than any laboratory writes, less than fills a computer.

README.md beside this file shows the same table to people; a test holds the two together. Each limit is raised (or
lowered) by an environment variable of its name.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass

from bench.errors import InputError


@dataclass(frozen=True)
class Limit:
    """One limit.

    Attributes:
        variable: Environment variable that takes its place.
        most: What is still read.
        unit: Of what.
        reason: Where the number comes from.
    """

    variable: str
    most: int
    unit: str
    reason: str

    @property
    def value(self) -> int:
        """What counts in this process.

        Raises:
            InputError: The environment variable is no whole number above zero.
        """
        text = os.environ.get(self.variable, "").strip()
        if not text:
            return self.most
        if not (text.isascii() and text.isdigit() and len(text) < 19 and int(text) > 0):  # 19 digits exceed 64 bits
            raise InputError(f"{self.variable}={text[:40]!r}: is no whole number above zero; correct or unset it.")
        return int(text)

    def exceeded(self, found: float) -> bool:
        """Whether something is larger than what is read."""
        return found > self.value

    @property
    def remedy(self) -> str:
        """What to do about a file that exceeds it."""
        return f"is that meant? then set {self.variable} to more"

    def __str__(self) -> str:
        return f"{self.value:,} {self.unit}".replace(",", " ")


YAML_BYTES = Limit(
    "BENCH_MOST_YAML_BYTES", 2_000_000, "bytes", "PyYAML reads some 300 kB/s; 40 000 runs without a note fit in"
)
YAML_DEPTH = Limit("BENCH_MOST_YAML_DEPTH", 30, "levels", "assumed: five times what any file of the bench has")
YAML_VALUES = Limit("BENCH_MOST_YAML_VALUES", 100_000, "values", "aliases written out; 10 000 runs fit in")
JSON_BYTES = Limit("BENCH_MOST_JSON_BYTES", 50_000_000, "bytes", "a covariance of 1500 figures takes 45 MB")
TABLE_BYTES = Limit("BENCH_MOST_TABLE_BYTES", 500_000_000, "bytes", "assumed: the cells below, at 25 bytes in CSV")
TABLE_CELLS = Limit("BENCH_MOST_TABLE_CELLS", 20_000_000, "cells", "two hours of 40 channels at 60 Hz; 160 MB")
TABLE_COLUMNS = Limit("BENCH_MOST_TABLE_COLUMNS", 1_000, "columns", "assumed: all channels of 30 drives are 300")
CAMPAIGN_CELLS = Limit("BENCH_MOST_CAMPAIGN_CELLS", 100_000_000, "cells", "of all tables; 800 MB")
CAMPAIGN_RUNS = Limit("BENCH_MOST_CAMPAIGN_RUNS", 5_000, "runs", "assumed: a run each ten minutes for a month")
FOLDER_ENTRIES = Limit("BENCH_MOST_FOLDER_ENTRIES", 50_000, "files", "assumed: ten files for each run")
SIMULATED_SECONDS = Limit(
    "BENCH_MOST_SIMULATED_SECONDS", 10_000, "seconds", "assumed: of a scenario; `session`, the longest, takes 2550"
)
MODEL_BYTES = Limit("BENCH_MOST_MODEL_BYTES", 50_000_000, "bytes", "an MJCF with its includes; meshes count apart")
MODEL_DEPTH = Limit("BENCH_MOST_MODEL_DEPTH", 300, "levels", "assumed: a chain of 100 bodies; far below the stack")
MODEL_INCLUDES = Limit("BENCH_MOST_MODEL_INCLUDES", 200, "includes", "assumed: a file for each part of an arm")
MODEL_COPIES = Limit(
    "BENCH_MOST_MODEL_COPIES", 2_000, "copies", "replicate and composite, multiplied; MuJoCo takes their square: 2 s"
)
MODEL_ELEMENTS = Limit(
    "BENCH_MOST_MODEL_ELEMENTS",
    20_000,
    "elements",
    "of an MJCF or URDF with its includes, and numbers of its sensors; 100 000 sites take minutes",
)
ASSET_BYTES = Limit("BENCH_MOST_ASSET_BYTES", 500_000_000, "bytes", "assumed: one mesh or texture")
MODEL_SECONDS = Limit("BENCH_MOST_MODEL_SECONDS", 15, "seconds", "assumed: of the processor, to compile a model once")
MODEL_MEMORY = Limit("BENCH_MOST_MODEL_MEMORY", 4_000_000_000, "bytes", "assumed: to compile a model once")

LIMITS: Sequence[Limit] = (
    *(YAML_BYTES, YAML_DEPTH, YAML_VALUES, JSON_BYTES),
    *(TABLE_BYTES, TABLE_CELLS, TABLE_COLUMNS, CAMPAIGN_CELLS, CAMPAIGN_RUNS, FOLDER_ENTRIES, SIMULATED_SECONDS),
    *(MODEL_BYTES, MODEL_DEPTH, MODEL_INCLUDES, MODEL_COPIES, MODEL_ELEMENTS, ASSET_BYTES, MODEL_SECONDS, MODEL_MEMORY),
)


def table() -> str:
    """Return the table of limits in Markdown, as it stands in README.md."""
    lines = ["| environment variable | read up to | why |", "|---|---|---|"]
    for limit in LIMITS:
        most = f"{limit.most:,} {limit.unit}".replace(",", " ")
        lines.append(f"| `{limit.variable}` | {most} | {limit.reason} |")
    return "\n".join(lines)
