"""What healthy tables of readings look like, one rule for each kind of fault.

A rule takes a `Sheet` and yields findings; its docstring says what is healthy. The rules run in this order, and a
column in which one of them found an error is not shown to the next, so that one fault is reported once.
"""

from collections.abc import Callable, Iterator

from bench.record.finding import Finding
from bench.record.rules import (
    alignment,
    clock,
    copies,
    filled_gaps,
    labels,
    names,
    pairing,
    row_order,
    scale,
    spikes,
    stuck,
    tracker,
    values,
    weights,
    work,
)
from bench.record.rules.sheet import Sheet

Rule = Callable[[Sheet], Iterator[Finding]]

HEADER_RULES: tuple[Rule, ...] = (names.known, names.enough, names.fits_arm, names.reflectors)

READING_RULES: tuple[Rule, ...] = (
    values.finite,
    values.plausible,
    clock.rises,
    clock.is_long_enough,
    clock.is_regular,
    labels.are_counts,
    labels.tell_readings_apart,
    labels.complete_states,
    labels.agree_with_pose,
    labels.hang_one_load,
    scale.angles,
    scale.magnitudes,
    spikes.no_spikes,
    spikes.no_outliers,
    stuck.frozen_or_saturated,
    stuck.all_frozen,
    filled_gaps.readings_are_noisy_throughout,
    row_order.rows_keep_their_labels,
    tracker.sees_reflectors,
    copies.identical,
    pairing.encoders_follow,
    pairing.encoders_rest_at_their_command,
    pairing.sensors_agree,
    weights.masses_hang,
    weights.loads_are_felt,
    weights.zero_is_set,
    weights.moments_are_about_the_load_point,
    alignment.leads,
    work.friction_takes,
)


OF_ARM: tuple[Rule, ...] = (names.fits_arm, names.reflectors, scale.angles)  # no other rule looks at the robot


def suits_arm(sheet: Sheet) -> bool:
    """Whether knowing the robot adds no finding to what the rules find in a sheet without errors."""
    return not any(True for rule in OF_ARM if len(sheet.run) or rule in HEADER_RULES for _ in rule(sheet))


def examine(sheet: Sheet) -> list[Finding]:
    """Put one sheet through all rules."""
    findings: list[Finding] = []
    for rule in HEADER_RULES + (READING_RULES if len(sheet.run) else ()):
        found = list(rule(sheet))
        findings += found
        sheet = sheet.without({finding.column for finding in found if finding.level == "error"})
    return findings
