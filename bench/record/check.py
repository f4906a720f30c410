"""Read a campaign folder and find everything that is wrong with it. There is no other reader."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bench.record.campaign import Arm, Campaign, Run
from bench.record.finding import Finding, Report
from bench.record.manifest import SUFFIXES, RunEntry, read_manifest
from bench.record.rules import examine
from bench.record.rules.names import SET_ASIDE
from bench.record.rules.session import no_overlap
from bench.record.rules.sheet import Sheet
from bench.record.table import Table, read_table


def check_campaign(folder: Path, arm: Arm | None = None) -> Report:
    """Read a campaign folder, and report every fault and every doubt at once.

    Args:
        folder: A folder with a `campaign.yaml`.
        arm: The robot, if it is known; then joints and their limits are checked too.
    """
    manifest = read_manifest(folder)
    tables = [(entry, read_table(folder, entry.path)) for entry in manifest.runs]
    sheets = [_sheet(entry, table, arm) for entry, table in tables if table.names]
    findings = [
        *manifest.findings,
        *(finding for _, table in tables for finding in table.findings),
        *examine_all(sheets),
        *(() if manifest.findings else _forgotten(folder, {entry.path for entry in manifest.runs})),
    ]
    head = manifest.head
    if head is None or any(finding.level == "error" for finding in findings):
        return Report(folder, tuple(findings), None)
    runs = tuple(sorted((sheet.run for sheet in sheets), key=lambda run: run.start_s))
    return Report(folder, tuple(findings), Campaign(head.robot, runs, head.started, head.noise, head.notes))


def examine_all(sheets: Sequence[Sheet]) -> list[Finding]:
    """Put all runs of one campaign through the rules."""
    with np.errstate(under="ignore"):  # squares of readings near zero
        return [finding for sheet in sheets for finding in examine(sheet)] + list(no_overlap(sheets))


def _sheet(entry: RunEntry, table: Table, arm: Arm | None) -> Sheet:
    columns = {name: values for name, values in table.columns.items() if not name.startswith(SET_ASIDE)}
    return Sheet(Run(entry.name, entry.kind, entry.start_s, columns, entry.note), entry.path, table.names, arm)


def _forgotten(folder: Path, listed: set[str]) -> list[Finding]:
    """Return a warning for each table in the folder that no run names."""
    known = {(folder / file).resolve() for file in listed}
    tables = sorted(path for suffix in SUFFIXES for path in folder.rglob(f"*{suffix}") if path.resolve() not in known)
    remedy = "list it in campaign.yaml, or move it away"
    return [
        Finding("warning", path.relative_to(folder).as_posix(), None, "", "no run names this table", remedy)
        for path in tables
    ]
