"""What a check found: one fault or one failed plausibility check, with its place and what to do about it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from bench.errors import MOST_OF_NAME, CampaignError, printable
from bench.record.campaign import Campaign

Level = Literal["error", "doubt", "warning"]

MAX_RANGES = 12  # stretches of rows that a message spells out; a table that is wrong throughout would fill the screen


@dataclass(frozen=True)
class Finding:
    """One fault or failed plausibility check.

    Attributes:
        level: "error": the campaign cannot be used. "doubt", a failed plausibility check: it can be read, but a channel
            is hardly what its name says, and what follows from it would be wrong. "warning": it is used, but somebody
            should look.
        file: Path relative to the campaign folder.
        row: First data row that it concerns, counted from 1 without the header; None: no single row.
        column: Column of a table, or key of the manifest ("runs[2].kind"); empty: the whole file.
        message: What is wrong, and in which other rows.
        remedy: What to do.
        lines_before: Lines of the file above its first data row.
    """

    level: Level
    file: str
    row: int | None
    column: str
    message: str
    remedy: str
    lines_before: int = 1

    @property
    def label(self) -> str:
        """What people read in front of it."""
        return "failed check" if self.level == "doubt" else self.level

    @property
    def line(self) -> int | None:
        """Line of the file, counted from 1, that `row` stands in; None where there are no lines to count."""
        if self.row is None or self.file.lower().endswith(".parquet"):
            return None
        return self.row + self.lines_before

    def __str__(self) -> str:
        place = self.file
        if self.row is not None:
            place += f": row {self.row}" + (f" (line {self.line})" if self.line else "")
        if self.column:
            place += f": {self.column[:MOST_OF_NAME]}"
        return printable(f"{place}: {self.message}; {self.remedy}".replace("\n", "\\n"))


@dataclass(frozen=True)
class Report:
    """Everything that a check found.

    Attributes:
        folder: What was checked.
        findings: In the order of the files; all levels mixed.
        campaign: What was read; None if there is an error.
    """

    folder: Path
    findings: tuple[Finding, ...]
    campaign: Campaign | None

    @property
    def errors(self) -> tuple[Finding, ...]:
        """Findings that keep the campaign from being used."""
        return tuple(finding for finding in self.findings if finding.level == "error")

    @property
    def doubts(self) -> tuple[Finding, ...]:
        """Findings that a diagnosis does not go past unless it is told to."""
        return tuple(finding for finding in self.findings if finding.level == "doubt")

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Findings that somebody should look at."""
        return tuple(finding for finding in self.findings if finding.level == "warning")

    def usable(self) -> Campaign:
        """Return the campaign.

        Raises:
            CampaignError: There are errors; `problems` holds each kind of them, with its places.
        """
        if self.campaign is None:
            from bench.record.logs.likewise import at_a_glance  # here: it knows findings

            raise CampaignError(f"{self.folder}/{error}" for error in at_a_glance(self.errors))
        return self.campaign


def spell_rows(rows: Sequence[int]) -> str:
    """Return "row 3" or "rows 3, 7 to 9 and 12" for 1-based rows in rising order; long lists are cut and counted."""
    ranges: list[list[int]] = []
    for row in rows:
        if ranges and row == ranges[-1][-1] + 1:
            ranges[-1].append(row)
        else:
            ranges.append([row])
    shown = [text for stretch in ranges[:MAX_RANGES] for text in _spell_range(stretch)]
    if rest := sum(len(stretch) for stretch in ranges[MAX_RANGES:]):
        shown.append(f"{rest} more")
    listed = shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"
    return f"row{'s' if len(rows) > 1 else ''} {listed}"


def counted(number: int, noun: str) -> str:
    """Return "1 run" or "2 runs"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _spell_range(rows: Sequence[int]) -> list[str]:
    return [f"{rows[0]} to {rows[-1]}"] if len(rows) > 2 else [str(row) for row in rows]
