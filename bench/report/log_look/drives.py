"""Lines of a proposed `log.yaml` for torques and currents, held against the robot where it is known."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.identify.directions import Flags
from bench.identify.drive_scale import DriveScale, drive_scale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.report.log_look.lines import Line, as_logged, si_factor
from bench.report.log_look.scaled import named_by_constants, scaled
from bench.report.log_look.slow import Slow, slow_motion
from bench.robot.nominal_dynamics import NominalDynamics

EXPLAINED = 0.5  # share of a reading's variance, mean over drives, from which it is a torque or a current (assumed)
SILENT = 0.05  # share of one reading, below which it has nothing of a joint that moves (assumed; chance explains 1 %)
MOVES_RAD, MOVES_M = 0.1, 0.02  # of a joint, from which friction and load show in what its drive reports (assumed)


@dataclass(frozen=True)
class Drives:
    """What was found of the drives.

    Attributes:
        lines: Of torques and currents.
        turned: Numbers of the drives whose angles count the other way round than the model's.
        questions: What somebody should look at.
    """

    lines: tuple[Line, ...]
    turned: frozenset[int] = frozenset()
    questions: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Held:
    """Readings held against the robot.

    Attributes:
        family: What they seem to be.
        scale: How they compare.
        left_out: Column -> why it tells nothing.
    """

    family: Family
    scale: DriveScale
    left_out: Mapping[str, str]


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
    tried = [_held(family, slow, nominal, angle_sigma, remarks) for family in families]
    every = [one for one in tried if one is not None]
    named = [one for one in every if one.family.kind != "unknown"]
    if nameless := [one for one in every if one.family.kind == "unknown"]:
        one = _measured(nameless, columns, remarks)
        named.append(replace(one, family=named_by_constants(one.family, one.scale, nominal, remarks)))
    found: list[Line] = []
    turned: set[int] = set()
    questions: list[str] = []
    for kind in ("tau_motor", "current"):
        fitting = [held for held in named if (held.family.kind == "current") == (kind == "current")]
        if fitting:
            held = _measured(fitting, columns, remarks)
            found += [_left_out(line, held) for line in scaled(held.family, held.scale, nominal, remarks)]
            turned |= set((np.flatnonzero(held.scale.angles.turned) + 1).tolist())
            questions += [
                f"{source} {why}: left out below, look at that channel" for source, why in held.left_out.items()
            ]
    return Drives(tuple(found), frozenset(turned), tuple(questions))


def _left_out(line: Line, held: _Held) -> Line:
    """Return the line of a column that tells nothing as a comment."""
    if line.source not in held.left_out:
        return line
    return replace(line, factor=si_factor(held.family), is_open=True, why=held.left_out[line.source])


def _unscaled(families: Sequence[Family]) -> Drives:
    """Return the first family of each quantity as it is logged."""
    first = {family.kind: family for family in reversed(families) if family.kind != "unknown"}
    return Drives(tuple(line for family in first.values() for line in as_logged(family)))


def _held(family: Family, slow: Slow, nominal: NominalDynamics, angle_sigma: Array, remarks: list[str]) -> _Held | None:
    """Return how a family, in the SI unit of its name, compares with the torque that the arm needs.

    Columns that stand still, or carry nothing of the motion of a joint that moves, do not count. None if the others
    have little to do with the torque.
    """
    if family.sources not in slow.readings:
        remarks.append(f"{family.shown}: stand still; not taken")
        return None
    reading, counts = slow.readings[family.sources], slow.moves[family.sources]
    sigma = angle_sigma if np.any(angle_sigma > 0) else None
    scale = drive_scale(nominal, slow.time, slow.position, reading, sigma, counts)
    left_out = {
        source: f"stands still at {reading[0, k]:.4g}" for k, source in enumerate(family.sources) if not counts[k]
    }
    silent = counts & _moves(slow.position, nominal) & (np.nan_to_num(scale.explained) < SILENT)
    share = float(np.mean(scale.explained[counts]))
    if np.any(silent) and np.sum(counts) >= 2 * np.sum(silent) and family.kind != "unknown":
        left_out |= {
            family.sources[k]: f"carries nothing of the motion ({100 * scale.explained[k]:.0f} % explained)"
            for k in np.flatnonzero(silent).tolist()
        }
        scale = drive_scale(nominal, slow.time, slow.position, reading, sigma, counts & ~silent)
        share = float(np.mean(scale.explained[counts & ~silent]))
    if share < EXPLAINED:
        remarks.append(f"{family.shown}: the model explains {100 * share:.0f} % of it; not taken")
        return None
    return _Held(family, replace(scale, factor=scale.factor / si_factor(family)), left_out)


def _moves(position: Array, nominal: NominalDynamics) -> Flags:
    """Return which joints move so far that friction alone shows in a reading, shape (n,)."""
    return np.asarray(np.ptp(position, axis=0) > np.where(nominal.bodies.is_hinge, MOVES_RAD, MOVES_M))


def _measured(fitting: Sequence[_Held], columns: Mapping[str, Array], remarks: list[str]) -> _Held:
    """Return the family that was measured: of those without names the roughest, of those with names the best explained.

    What is commanded or computed has no noise, but its last decimals: of a drive that needs hardly any torque they are
    all there is, so the middle of the drives counts.
    """

    def rank(held: _Held) -> float:
        family = held.family
        if family.kind != "unknown":
            return 1 + float(np.mean(np.nan_to_num(held.scale.explained)))
        moves = [columns[name] for name in family.sources if np.ptp(columns[name]) > 0]
        step = float(np.median([np.mean(np.abs(np.diff(values, n=2))) / np.std(values) for values in moves]))
        return step / (1 + step)

    best = max(fitting, key=rank)
    for held in fitting:
        if held is not best:
            remarks.append(
                f"{held.family.shown}: follow the torque too; {best.family.shown} are taken, as what was measured "
                "(sensors behind the gears feel no friction of the drives: take the torques of motors, to model these)"
            )
    return best
