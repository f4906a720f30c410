"""Angles of the motors in a log: their gear ratios, as the figures state them, as other angles or torques tell them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.identify.angle_scale import AngleScale, angle_scale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.record.look.values import ALIKE
from bench.record.rules.scale import FAR
from bench.record.units import FOREIGN
from bench.report.log_look.angle_units import DEGREE, Side, reaches
from bench.report.log_look.lines import UNTOLD, Line
from bench.report.log_look.slow import Slow, slow_motion
from bench.report.log_look.turns import by_turns, in_rad
from bench.robot.nominal_dynamics import NominalDynamics

HALF = 0.5  # of what is unexplained: degrees become angles of the motor where less than that is left (assumed)
CLEARLY = 3.0  # standard deviations by which a scale must be off for that
SAME = 0.02  # relative: a command and an encoder of one unit that differ by less have one gear (following errors)
EXPLAINED = 0.5  # share of the readings, mean over drives, from which they tell a gear ratio (assumed)
NEAR_ONE = 0.25  # relative: an angle with a scale so near to one is one of the joint (masses and friction bend scales)
DIGITS = 4  # of a gear ratio that was estimated
ESTIMATED = (
    "gear ratios that were estimated from torques are as good as the robot's masses: write the true ones (gear_ratio "
    "of the drives in figures.yaml), for all angles and torques go by them"
)


@dataclass(frozen=True)
class Geared:
    """Lines of angles with the gear ratios that are known.

    Attributes:
        lines: Those that are still of the motor are open.
        sigma: Shape (n,), relative standard deviation of each drive's angle; 0 where nothing was estimated.
        questions: What somebody should look at.
    """

    lines: tuple[Line, ...]
    sigma: Array
    questions: tuple[str, ...]


def geared(
    lines: Sequence[Line],
    readings: Sequence[Family],
    time: Array,
    columns: Mapping[str, Array],
    nominal: NominalDynamics | None,
) -> Geared:
    """Bring angles of the motors to the joints.

    A stated gear ratio is used as it is. An angle that follows one of the same joint gets its ratio from that one.
    What is left is estimated from torques or currents. Lines of which all of this tells nothing are open.

    Args:
        lines: Of the angles.
        readings: Families that may be torques or currents.
        time: Shape (T,) [s].
        columns: Of the log.
        nominal: The robot, if it is known.
    """
    questions: list[str] = []
    if nominal is not None:
        lines = by_turns(lines, readings, time, columns, nominal, questions)
        lines = _by_figures(lines, columns, nominal)
    lines = _beside_others(lines, columns)
    sigma = np.zeros(0 if nominal is None else nominal.n_joints)
    if nominal is not None and any(line.side != "joint" for line in lines):
        slow = slow_motion(lines, readings, time, columns, nominal.n_joints)
        scale = _by_torques(slow, nominal) if slow is not None else None
        if slow is not None and scale is not None:
            stated = _by_figures([_refuted(line) for line in lines], columns, nominal)
            if not _are_nearer_to_degrees(slow, scale, {line.column: line for line in stated}):
                estimated = _estimated(lines, slow, scale)
                lines = [one if one.side == "joint" else other for one, other in zip(stated, estimated, strict=True)]
                guessed = {line.number for line in lines if line.was_estimated}
                sigma = np.where([number in guessed for number in range(1, nominal.n_joints + 1)], scale.sigma, 0.0)
                questions += [ESTIMATED] if guessed else []
                lines = _beside_others(lines, columns)
    lines = [_as_degrees(line) if line.side == "either" else line for line in lines]
    questions += _open_questions(lines, columns, nominal)
    return Geared(tuple(_opened(line) for line in lines), sigma, tuple(questions))


def _by_figures(lines: Sequence[Line], columns: Mapping[str, Array], nominal: NominalDynamics) -> list[Line]:
    """Return lines of the motor with the gear ratios of the robot's figures, where they state them.

    Angles without a unit are in radians if all of them are then in range, else in degrees.
    """
    ratios = {line.column: float(nominal.gear_ratio[line.number - 1]) for line in lines if line.side == "motor"}
    stated = {column: ratio for column, ratio in ratios.items() if np.isfinite(ratio)}
    reach = FAR * reaches(nominal, nominal.n_joints)
    is_rad = all(
        np.max(np.abs(columns[line.source])) / stated[line.column] <= reach[line.number - 1]
        for line in lines
        if line.column in stated and not line.unit
    )
    found = []
    for line in lines:
        if line.column not in stated:
            found.append(line)
            continue
        unit = line.unit or ("rad" if is_rad else "deg")
        ratio, to_rad = stated[line.column], line.factor if line.unit or is_rad else DEGREE
        why = line.and_why(f"angle of the motor in {unit}, gear ratio {ratio:.6g} of the figures")
        found.append(replace(line, factor=to_rad / ratio, side="joint", why=why))
    return found


def _beside_others(lines: Sequence[Line], columns: Mapping[str, Array]) -> list[Line]:
    """Return lines of the motor with the ratio to another angle of the joint, where there is one that they follow."""
    return [
        _beside(line, [o for o in lines if o.number == line.number and o.side == "joint"], columns) for line in lines
    ]


def _beside(line: Line, others: Sequence[Line], columns: Mapping[str, Array]) -> Line:
    if line.side != "motor":
        return line
    values = columns[line.source] - np.mean(columns[line.source])
    for other in others:
        known = other.factor * (columns[other.source] - np.mean(columns[other.source]))
        slope = float(np.dot(values, known) / max(float(np.dot(values, values)), np.finfo(float).tiny))
        if np.std(known) > 0 and np.std(known - slope * values) < ALIKE * np.std(known):
            factor = other.factor if abs(slope / other.factor - 1) < SAME else float(f"{slope:.5g}")
            said = f"gear ratio {abs(line.factor / factor):.{DIGITS}g}" if line.unit else "angle of the motor"
            why = line.and_why(f"{said}, as {other.source} has it")
            return replace(line, factor=factor, side="joint", why=why, was_estimated=other.was_estimated)
    return line


def _by_torques(slow: Slow, nominal: NominalDynamics) -> AngleScale | None:
    """Return the scales that explain one family of readings best; None if no family tells any, or none is needed."""
    sought = np.array([line.side != "joint" for line in slow.angles]) & nominal.bodies.is_hinge
    if not np.any(sought):
        return None
    found = [
        angle_scale(nominal, slow.time, slow.position, reading, sought, slow.moves[sources])
        for sources, reading in slow.readings.items()
    ]
    found = [scale for scale in found if scale.unexplained < 1 - EXPLAINED]
    if not found:
        return None
    best = min(found, key=lambda scale: scale.unexplained)
    if not np.any(sought & (best.sigma <= UNTOLD)):
        return None
    if all(line.side != "motor" for line in slow.angles) and not _is_clearly_another(best):
        return None
    return best


def _is_clearly_another(scale: AngleScale) -> bool:
    """Return whether angles that may be degrees at the joints are not, by the torque they need."""
    told = np.isfinite(scale.sigma) & (scale.sigma > 0)
    off = np.abs(np.log(scale.factor[told])) > CLEARLY * scale.sigma[told]
    return bool(np.any(off) and scale.unexplained < HALF * scale.unexplained_as_given)


def _are_nearer_to_degrees(slow: Slow, scale: AngleScale, stated: Mapping[str, Line]) -> bool:
    """Return whether angles that may be degrees are nearer to that, by torque, than to the stated gear ratios.

    Masses, a payload and friction that nobody stated bend the scales that torques tell; of two readings of a log that
    differ by a factor of two they leave the right one nearer.
    """
    off = []
    for k, line in enumerate(slow.angles):
        other = stated.get(line.column)
        if line.side == "either" and other and other.side == "joint" and scale.sigma[k] <= UNTOLD:
            size = np.log(scale.factor[k])
            off.append(abs(size) - abs(size - np.log(abs(other.factor / line.factor))))
    return bool(off) and sum(off) < 0


def _estimated(lines: Sequence[Line], slow: Slow, scale: AngleScale) -> list[Line]:
    """Return lines with the scales that torques tell; those that are told too badly stay of the motor."""
    at = {line.column: k for k, line in enumerate(slow.angles) if line.side != "joint"}
    return [_estimated_line(line, scale, at[line.column]) if line.column in at else _refuted(line) for line in lines]


def _as_degrees(line: Line) -> Line:
    """Return an angle in range as degrees as one of the joint: nothing speaks against it."""
    return replace(line, side="joint", why=f"{line.why}, so degrees" if line.why else "")


def _refuted(line: Line) -> Line:
    """Return an angle that seemed to be one of the joint in degrees as one of the motor in an unknown unit."""
    return replace(line, side="motor", factor=1.0, unit="") if line.side == "either" else line


def _estimated_line(line: Line, scale: AngleScale, k: int) -> Line:
    factor, sigma = float(f"{line.factor * scale.factor[k]:.{DIGITS}g}"), float(scale.sigma[k])
    given = _refuted(line)
    ratio = given.factor / factor  # in the unit of its name, else in radians
    if sigma <= UNTOLD and abs(np.log(ratio)) < np.log(1 + NEAR_ONE):
        return replace(given, unit=given.unit or "rad", side="joint", why=in_rad(given))
    side: Side = "motor" if sigma > UNTOLD or ratio < 1 else "joint"  # no gear is faster at the joint
    told = f"+- {100 * sigma:.0f} %, estimated from torques" if np.isfinite(sigma) else "is not told by torques"
    return replace(
        given, factor=factor, side=side, why=given.and_why(f"{_ratio(given, factor)} {told}"), was_estimated=True
    )


def _ratio(given: Line, factor: float) -> str:
    if given.unit:
        return f"gear ratio {given.factor / factor:.3g}"
    return f"angle of the motor, gear ratio {1 / factor:.3g} if it is in rad, {DEGREE / factor:.3g} if in degrees,"


def _opened(line: Line) -> Line:
    """Return a line of the motor as a comment: nobody knows its factor yet."""
    if line.side != "motor":
        return line
    return replace(line, is_open=True, why=line.and_why("motor side? see above"))


def _open_questions(
    lines: Sequence[Line], columns: Mapping[str, Array], nominal: NominalDynamics | None
) -> Iterator[str]:
    """Yield what to write for angles that are beyond their joints, once for all columns of a unit."""
    beyond = [line for line in lines if line.side == "motor"]
    for unit in dict.fromkeys(line.unit for line in beyond):
        of_unit = [line for line in beyond if line.unit == unit]
        to_rad = FOREIGN[unit].factor if unit in FOREIGN else 1.0
        factor = f"{to_rad:.10g} / N" if unit else f"1 / N, or in degrees {DEGREE:.10g} / N,"
        seen = ", ".join(
            f"{line.source} {np.max(np.abs(columns[line.source])):.4g}{_of_joint(line, nominal)}" for line in of_unit
        )
        many = "s" if len(of_unit) > 1 else ""
        yield (
            f"motor side? angles reach {seen}{f' {unit}' if unit else ', in rad or degrees'}; "
            f"this log does not tell the gear ratio{many} N: write {factor} as the factor of "
            f"{', '.join(line.column for line in of_unit)}, or N as gear_ratio into figures.yaml and look again"
        )


def _of_joint(line: Line, nominal: NominalDynamics | None) -> str:
    """Return how far the joint goes, in words, in the unit of the line."""
    if nominal is None:
        return ""
    reach = reaches(nominal, nominal.n_joints)[line.number - 1]
    name = nominal.bodies.names[line.number - 1]
    return f" (joint {name} {reach / DEGREE:.3g})" if line.unit == "deg" else f" (joint {name} {reach:.3g} rad)"
