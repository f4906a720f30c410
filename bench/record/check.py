"""Read a campaign folder and find everything that is wrong with it. There is no other reader."""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from bench.record.campaign import Arm, Campaign, Run, in_order
from bench.record.finding import Finding, Report
from bench.record.known import Known, contradictions
from bench.record.limits import CAMPAIGN_CELLS, FOLDER_ENTRIES
from bench.record.manifest import MANIFEST, SUFFIXES, Manifest, RunEntry, read_manifest
from bench.record.rules import examine, suits_arm
from bench.record.rules.session import examine_session
from bench.record.rules.sheet import Sheet
from bench.record.table import SET_ASIDE, Table, read_table


@dataclass(frozen=True, eq=False)
class _Content:
    """What stands in a campaign folder, with what is wrong with its files.

    Attributes:
        folder: Where it stands.
        manifest: Its `campaign.yaml`.
        sheets: Tables that could be taken apart, in the order of the manifest; no robot is known to them.
        faults: What is wrong with the tables as files.
        forgotten: A warning for each table that no run names.
    """

    folder: Path
    manifest: Manifest
    sheets: tuple[Sheet, ...]
    faults: tuple[Finding, ...]
    forgotten: tuple[Finding, ...]

    def report(self, of_sheets: Sequence[Sequence[Finding]]) -> Report:
        """Return the report, given what the rules find in each sheet."""
        in_tables = [finding for found in of_sheets for finding in found]
        findings = (*self.manifest.findings, *self.faults, *in_tables, *self._of_session, *self.forgotten)
        findings += tuple(_contradictions(self.manifest.known))
        head = self.manifest.head
        if head is None or any(finding.level == "error" for finding in findings):
            return Report(self.folder, findings, None)
        runs = in_order([sheet.run for sheet in self.sheets])
        return Report(
            self.folder, findings, Campaign(head.robot, runs, head.started, head.noise, head.notes, self.manifest.known)
        )

    @cached_property
    def _of_session(self) -> Sequence[Finding]:
        """What the rules find in all sheets together."""
        return examine_session(self.sheets)


def check_campaign(folder: Path, arm: Arm | None = None) -> Report:
    """Read a campaign folder, and report every fault and every doubt at once.

    Args:
        folder: A folder with a `campaign.yaml`.
        arm: The robot, if it is known; then joints and their limits are checked too.
    """
    content = _content(folder)
    return content.report([_examine(replace(sheet, arm=arm)) for sheet in content.sheets])


def check_with_robot(folder: Path, arm_of: Callable[[str], Arm]) -> Report:
    """Read a campaign folder once, and check it without its robot; if no error is found, with its robot.

    Args:
        folder: A folder with a `campaign.yaml`.
        arm_of: Gives the robot that the campaign names; called only if the campaign can be used without knowing it.

    Raises:
        Exception: Whatever `arm_of` raises.
    """
    content = _content(folder)
    found = [_examine(sheet) for sheet in content.sheets]
    report = content.report(found)
    if report.campaign is None:
        return report
    arm = arm_of(report.campaign.robot)
    sheets = [replace(sheet, arm=arm) for sheet in content.sheets]
    return content.report(
        [before if suits_arm(sheet) else _examine(sheet) for sheet, before in zip(sheets, found, strict=True)]
    )


def examine_all(sheets: Sequence[Sheet]) -> list[Finding]:
    """Put all runs of one campaign through the rules."""
    return [finding for sheet in sheets for finding in _examine(sheet)] + examine_session(sheets)


def _examine(sheet: Sheet) -> list[Finding]:
    with np.errstate(under="ignore"):  # squares of readings near zero
        return examine(sheet)


def _content(folder: Path) -> _Content:
    manifest = read_manifest(folder)
    tables, too_many = _tables(folder, manifest.runs)
    return _Content(
        folder,
        manifest,
        tuple(_sheet(entry, table) for entry, table in tables if table.names),
        (*(finding for _, table in tables for finding in table.findings), *too_many),
        () if manifest.findings else tuple(_forgotten(folder, {entry.path for entry in manifest.runs})),
    )


def _sheet(entry: RunEntry, table: Table) -> Sheet:
    columns = {name: values for name, values in table.columns.items() if not name.startswith(SET_ASIDE)}
    return Sheet(
        Run(entry.name, entry.kind, entry.start_s, columns, entry.note, entry.recording), entry.path, table.names
    )


def _tables(folder: Path, entries: Sequence[RunEntry]) -> tuple[list[tuple[RunEntry, Table]], list[Finding]]:
    """Read tables until there are more cells than are read of a campaign."""
    tables: list[tuple[RunEntry, Table]] = []
    cells = 0
    for entry in entries:
        table = read_table(folder, entry.path)
        cells += sum(len(values) for values in table.columns.values())
        if CAMPAIGN_CELLS.exceeded(cells):
            message = f"the tables up to this one have more than {CAMPAIGN_CELLS}"
            return tables, [Finding("error", entry.path, None, "", message, CAMPAIGN_CELLS.remedy)]
        tables.append((entry, table))
    return tables, []


def _contradictions(known: Sequence[Known]) -> Iterator[Finding]:
    """Yield a warning for each thing that is known twice, and not alike."""
    for key, words in contradictions(known):
        yield Finding("warning", MANIFEST, None, key, words, "correct one of them, or its sigma")


def _forgotten(folder: Path, listed: set[str]) -> list[Finding]:
    """Return a warning for each table in the folder that no run names."""
    known = {os.path.realpath(folder / file) for file in listed}
    found = sorted(path for path in _files(folder) if path.suffix in SUFFIXES and os.path.realpath(path) not in known)
    remedy = "list it in campaign.yaml, or move it away"
    return [
        Finding("warning", path.relative_to(folder).as_posix(), None, "", "no run names this table", remedy)
        for path in found
    ]


def _files(folder: Path) -> Iterator[Path]:
    """Yield what is in a folder and in the folders in it, without following links; no more than the limit."""
    folders = [folder]
    seen = 0
    while folders:
        try:
            entries = list(os.scandir(folders.pop()))
        except OSError:  # not ours to look into; nothing in it was asked for
            continue
        for entry in entries:
            seen += 1
            if FOLDER_ENTRIES.exceeded(seen):
                return
            if entry.is_dir(follow_symlinks=False):
                folders.append(Path(entry.path))
            else:
                yield Path(entry.path)
