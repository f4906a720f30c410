"""Lines of a proposed `log.yaml` for torques and currents, held against the robot where it is known."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.identify.drive_scale import DriveScale, drive_scale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.report.log_look.lines import Line, as_logged, si_factor
from bench.report.log_look.scaled import named_by_constants, scaled
from bench.report.log_look.slow import Slow, slow_motion
from bench.robot.nominal_dynamics import NominalDynamics

EXPLAINED = 0.5  # share of a reading's variance, mean over drives, from which it is a torque or a current (assumed)


@dataclass(frozen=True)
class Drives:
    """What was found of the drives.

    Attributes:
        lines: Of torques and currents.
        turned: Numbers of the drives whose angles count the other way round than the model's.
    """

    lines: tuple[Line, ...]
    turned: frozenset[int] = frozenset()


def readings_of(families: Sequence[Family]) -> list[Family]:
    """Return the families that may be torques or currents."""
    return [f for f in families if f.kind in ("torque", "current", "unknown") and not f.is_command]


def drives(
    families: Sequence[Family],
    lines: Sequence[Line],
    time: Array,
    columns: Mapping[str, Array],
    nominal: NominalDynamics | None,
    angle_sigma: Array,
    remarks: list[str],
) -> Drives:
    """Return the lines of torques and currents, one family for each quantity.

    Args:
        families: Those that may be torques or currents (`readings_of`).
        lines: Those of the angles.
        time: Shape (T,) [s].
        columns: Of the log.
        nominal: The robot, if it is known.
        angle_sigma: Shape (n,), relative standard deviation of the scale of each angle, where it was estimated.
        remarks: To which is added what was taken, and what was not.
    """
    if nominal is None:
        unknown = [family.shown for family in families if family.kind == "unknown"]
        if unknown:
            remarks.append(f"{', '.join(unknown)}: move with the robot; currents or torques? --robot DIR tells")
        if len(unknown) < len(families):
            remarks.append("torques and currents are as logged: --robot DIR tells gear ratio, sign and delay")
        return _unscaled(families)
    slow = slow_motion(lines, families, time, columns, nominal.n_joints)
    if slow is None:
        if families:
            remarks.append("nothing tells torques and currents: a drive has no angle, or the log is too short")
        return Drives(())
    if any(line.side == "motor" and not line.was_estimated for line in slow.angles):
        remarks.append("torques and currents are as logged: nothing tells factors and signs before angles are known")
        return _unscaled(families)
    scales = [(family, _scale(family, slow, nominal, angle_sigma, remarks)) for family in families]
    scales = [(f if s is None else named_by_constants(f, s, nominal, remarks), s) for f, s in scales]
    found: list[Line] = []
    turned: set[int] = set()
    for kind in ("tau_motor", "current"):
        fitting = [(f, s) for f, s in scales if s is not None and (f.kind == "current") == (kind == "current")]
        if fitting:
            family, scale = _measured(fitting, columns, remarks)
            found += scaled(family, scale, nominal, remarks)
            turned |= set((np.flatnonzero(scale.turned) + 1).tolist())
    return Drives(tuple(found), frozenset(turned))


def _unscaled(families: Sequence[Family]) -> Drives:
    """Return the first family of each quantity as it is logged."""
    first = {family.kind: family for family in reversed(families) if family.kind != "unknown"}
    return Drives(tuple(line for family in first.values() for line in as_logged(family)))


def _scale(
    family: Family, slow: Slow, nominal: NominalDynamics, angle_sigma: Array, remarks: list[str]
) -> DriveScale | None:
    """Return how a family, in the SI unit of its name, compares with the torque that the arm needs.

    None if it has little to do with it.
    """
    if family.sources not in slow.readings:
        return None
    is_given = bool(np.any(angle_sigma > 0))
    reading = slow.readings[family.sources]
    scale = drive_scale(nominal, slow.time, slow.position, reading, angle_sigma if is_given else None)
    if np.mean(scale.explained) < EXPLAINED:
        remarks.append(f"{family.shown}: the model explains {100 * np.mean(scale.explained):.0f} % of it; not taken")
        return None
    return replace(scale, factor=scale.factor / si_factor(family))


def _measured(
    fitting: Sequence[tuple[Family, DriveScale]], columns: Mapping[str, Array], remarks: list[str]
) -> tuple[Family, DriveScale]:
    """Return the family that was measured: of those without names the roughest, of those with names the best explained.

    What is commanded or computed has no noise.
    """

    def rank(pair: tuple[Family, DriveScale]) -> float:
        family, scale = pair
        if family.kind != "unknown":
            return 1 + float(np.mean(scale.explained))
        step = [np.mean(np.abs(np.diff(columns[name], n=2))) / np.std(columns[name]) for name in family.sources]
        return float(np.mean(step) / (1 + np.mean(step)))

    best = max(fitting, key=rank)
    for family, _ in fitting:
        if family is not best[0]:
            remarks.append(f"{family.shown}: follow the torque too; {best[0].shown} are taken, as what was measured")
    return best
