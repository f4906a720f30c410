"""One fault said once, in however many columns and files it stands."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import get_args

from bench.record.finding import Finding, Level

SPELT = 6  # names that a message spells out
LEVELS = get_args(Level)  # the worst first
FEW = 3  # findings that are all shown, with their own figures
_FIGURES = re.compile(r"rows? \d[\d, ]*((to|and|more) [\d, ]*)*|-?\d+(\.\d+)?([eE][+-]?\d+)?|'[^']*'")


def likewise(findings: Iterable[Finding]) -> list[Finding]:
    """Return the first of all findings that say the same but for figures, with the places of the others."""
    return [_with_others(group) for group in _alike(findings)]


def at_a_glance(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings as people read them: a fault of many runs or columns is said once, with the other places.

    A few are shown one by one, and so is what is said of the channels of all runs together: their figures differ. What
    is worst comes first.
    """
    shown = []
    for group in _alike(findings):
        in_tables = len({finding.file for finding in group}) > 1 or group[0].row is not None
        shown += [_with_others(group)] if in_tables and len(group) > FEW else group
    return sorted(shown, key=lambda finding: LEVELS.index(finding.level))


def _alike(findings: Iterable[Finding]) -> list[list[Finding]]:
    """Return findings in groups that say the same but for figures."""
    alike: dict[tuple[str, ...], list[Finding]] = {}
    for finding in findings:
        key = (finding.level, _FIGURES.sub("#", finding.message), _FIGURES.sub("#", finding.remedy))
        alike.setdefault(key, []).append(finding)
    return list(alike.values())


def listed(names: Sequence[str]) -> str:
    """Return "a, b and 3 more"."""
    shown = ", ".join(names[:SPELT])
    return shown if len(names) <= SPELT else f"{shown} and {len(names) - SPELT} more"


def _with_others(group: Sequence[Finding]) -> Finding:
    first, others = group[0], group[1:]
    if not others:
        return first
    columns = list(dict.fromkeys(other.column for other in others if other.column and other.column != first.column))
    files = list(dict.fromkeys(other.file for other in others if other.file != first.file))
    also = [f"in {listed(columns)}"] if columns else []
    also += [f"in {listed(files)}"] if files else []
    return replace(first, message=f"{first.message} (likewise {' and '.join(also)})") if also else first
