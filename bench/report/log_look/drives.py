"""Lines of a proposed `log.yaml` for torques and currents, held against the robot where it is known."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.identify.drive_scale import DriveScale, drive_scale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.report.log_look.angle_units import SLOWEST_GEAR
from bench.report.log_look.lines import UNTOLD, Line, as_logged
from bench.report.log_look.slow import Slow, slow_motion
from bench.robot.nominal_dynamics import NominalDynamics

EXPLAINED = 0.5  # share of a reading's variance, mean over drives, from which it is a torque or a current (assumed)
NEAR_ONE = 0.25  # relative: a factor this near to one is no gear ratio; payload and masses may be off so far (assumed)
NINETY = 1.645  # exact: standard deviations to either side that hold 90 %
AT_LIMIT = 1e-2  # rounding: of a payload that was searched to a thousandth


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
        return _unscaled(families, columns)
    slow = slow_motion(lines, families, time, columns, nominal.n_joints)
    if slow is None:
        if families:
            remarks.append("nothing tells torques and currents: a drive has no angle, or the log is too short")
        return Drives(())
    if any(line.side == "motor" and not line.was_estimated for line in slow.angles):
        remarks.append("torques and currents are as logged: nothing tells factors and signs before angles are known")
        return _unscaled(families, columns)
    scales = [(family, _scale(family, slow, nominal, angle_sigma, remarks)) for family in families]
    found: list[Line] = []
    turned: set[int] = set()
    for kind in ("tau_motor", "current"):
        fitting = [(f, s) for f, s in scales if s is not None and (f.kind == "current") == (kind == "current")]
        if fitting:
            family, scale = _measured(fitting, columns, remarks)
            found += _scaled(family, scale, nominal, remarks)
            turned |= set((np.flatnonzero(scale.turned) + 1).tolist())
    return Drives(tuple(found), frozenset(turned))


def _unscaled(families: Sequence[Family], columns: Mapping[str, Array]) -> Drives:
    """Return the first family of each quantity as it is logged."""
    first = {family.kind: family for family in reversed(families) if family.kind != "unknown"}
    return Drives(tuple(line for family in first.values() for line in as_logged(family, columns)))


def _scale(
    family: Family, slow: Slow, nominal: NominalDynamics, angle_sigma: Array, remarks: list[str]
) -> DriveScale | None:
    """Return how a family compares with the torque that the arm needs; None if it has little to do with it."""
    if family.sources not in slow.readings:
        return None
    is_given = bool(np.any(angle_sigma > 0))
    reading = slow.readings[family.sources]
    scale = drive_scale(nominal, slow.time, slow.position, reading, angle_sigma if is_given else None)
    if np.mean(scale.explained) < EXPLAINED:
        remarks.append(f"{family.shown}: the model explains {100 * np.mean(scale.explained):.0f} % of it; not taken")
        return None
    return scale


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


def _is_of_joints(family: Family, scale: DriveScale) -> bool:
    """Return whether readings are torques at the joints: near to the model's, or in Nm and no gear ratio away from it.

    What is called a torque is one at the joint or one at the motor. The middle between both, on a logarithmic scale, is
    held against the mean of all drives, which counts those most that are told best. What has no name is one at the
    joint if the mean is near to the model's and no drive is surely off.
    """
    size = np.abs(scale.factor)
    if np.all(np.abs(size - 1) < NEAR_ONE):
        return True
    mean = float(np.average(np.log(size), weights=scale.sigma**-2.0))
    if family.kind == "torque":
        return bool(abs(mean) < 0.5 * np.log(SLOWEST_GEAR))
    is_sharp = NINETY * np.sum(scale.sigma**-2.0) ** -0.5 < NEAR_ONE
    return bool(is_sharp and abs(mean) < NEAR_ONE and np.all(np.abs(1 / size - 1) < NINETY * scale.sigma))


def _scaled(family: Family, scale: DriveScale, nominal: NominalDynamics, remarks: list[str]) -> Iterator[Line]:
    """Yield the lines of one family of readings that go by the torque that the arm needs."""
    names = nominal.bodies.names
    if np.any(scale.turned):
        who = ", ".join(name for name, turned in zip(names, scale.turned, strict=True) if turned)
        remarks.append(f"angles of {who} count the other way round than the model's: their factors are turned below")
        if np.any(scale.unsure):
            others = ", ".join(name for name, unsure in zip(names, scale.unsure, strict=True) if unsure)
            remarks.append(
                f"the direction of {others} is not told by torques (an arm and its mirror image need the same): look "
                "at the robot; an angle and its torque or current are turned together"
            )
    remarks.append(
        f"{family.shown}: held against the masses of the robot with {scale.payload:.3g} kg of payload, with which "
        f"all drives agree best; they {'lag' if scale.delay >= 0 else 'lead'} the angles by "
        f"{1e3 * abs(scale.delay):.1f} ms (what the model gets wrong of rotors and friction looks like that too)"
    )
    if 0 < nominal.payload <= scale.payload * (1 + AT_LIMIT):
        remarks.append(
            "that is the largest payload that may be unstated: if more hangs there, raise payload_kg in figures.yaml"
        )
    near = _is_of_joints(family, scale)
    if family.kind == "current":
        estimated = zip(names, scale.factor, scale.sigma, strict=True)
        constants = ", ".join(f"{name} {abs(k):.3g} +- {100 * s:.0f} %" for name, k, s in estimated)
        remarks.append(f"for figures.yaml, torque_constant_nm_per_a as estimated: {constants} (torque_constant_error)")
    elif near and np.any(np.abs(np.abs(scale.factor) - 1) >= NEAR_ONE):
        compared = zip(names, scale.factor, scale.sigma, strict=True)
        factors = ", ".join(f"{name} {abs(f):.3g} +- {100 * s:.0f} %" for name, f, s in compared)
        remarks.append(
            f"{family.shown}: taken as torques at the joints, for they are no gear ratio away from the model's; on the "
            f"motor's side they need gear ratios as factors. Model by reading: {factors}"
        )
    elif not near:
        widest = float(np.max(scale.sigma[scale.sigma < UNTOLD], initial=0.01))
        remarks.append(
            f"factors of {family.shown} are estimates: write gear ratios or constants there where they are known, else "
            f"`gain_sigma: {widest:.2g}` under instruments: torque: of figures.yaml"
        )
    for number, source in zip(family.numbers, family.sources, strict=True):
        k = number - 1
        told_sign = family.kind == "current" or NINETY * scale.sigma[k] < 1
        sign = float(np.sign(scale.factor[k])) if told_sign else 1.0
        unit = "nm" if nominal.bodies.is_hinge[k] else "n"
        told = f"{100 * scale.explained[k]:.0f} % explained"
        if family.kind == "current":
            direction = "turned, it counts against the model's torque" if sign < 0 else "sign as the model has it"
            yield Line(f"current_{number}_a", source, sign, 0.0, f"{told}; {direction}")
        elif near:
            off = abs(abs(scale.factor[k]) - 1)
            why = f"{told}; joint torque" + (f" within {100 * off:.0f} % of the model's" if off < NEAR_ONE else "")
            yield Line(f"tau_motor_{number}_{unit}", source, sign, 0.0, why)
        else:
            wide = scale.sigma[k] > UNTOLD
            remedy = ": not told by this log, write the gear ratio" if wide else ""
            why = f"{told}; +- {100 * scale.sigma[k]:.0f} %{remedy}"
            factor = float(f"{scale.factor[k]:.3g}")
            yield Line(f"tau_motor_{number}_{unit}", source, factor, 0.0, why, is_open=bool(wide))
