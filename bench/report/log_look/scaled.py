"""Lines of torques and currents that go by the torque which the arm needs: on which side of the gear, with what factor.

A unit in the name decides the power of ten, gear ratios and torque constants that the figures state are used as they
are, and only what is left is estimated. What the log contradicts is said.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.identify.directions import most_at_once
from bench.identify.drive_scale import AT_MOST, DriveScale
from bench.record.look.families import Family
from bench.report.log_look.angle_units import SLOWEST_GEAR
from bench.report.log_look.drive_factors import (
    NEAR_ONE,
    agree,
    contradictions,
    each_drive,
    estimate,
    explained,
    is_near,
    is_sharp,
    is_told,
    mean_over_drives,
    sign_of,
    torque_column,
    unit_words,
)
from bench.report.log_look.lines import UNTOLD, Line, si_factor
from bench.report.log_look.motor_torques import about_motor_torques, motor_factors, motor_torques
from bench.robot.nominal_dynamics import NominalDynamics


def named_by_constants(family: Family, scale: DriveScale, nominal: NominalDynamics, remarks: list[str]) -> Family:
    """Return readings without a name as currents if the figures state torque constants, and the log tells no others.

    That one drive is off is said later, as of readings that are called currents.
    """
    constants = nominal.stated_constant
    if family.kind != "unknown" or not np.all(np.isfinite(constants)) or agree(scale, np.ones_like(constants)):
        return family
    if not is_sharp(scale):
        why = "the figures state torque constants, and this log tells neither these nor others"
    elif is_near(scale, constants):
        why = "the torque constants of the figures fit them"
    else:
        return family
    remarks.append(f"{family.shown}: taken as currents, for {why}")
    return replace(family, kind="current")


def scaled(family: Family, scale: DriveScale, nominal: NominalDynamics, remarks: list[str]) -> Iterator[Line]:
    """Yield the lines of one family of readings that go by the torque that the arm needs.

    Args:
        family: One reading for each drive.
        scale: Its factors are by the SI unit of its name.
        nominal: The robot.
        remarks: To which is added what was taken.
    """
    remarks += _of_directions(scale, nominal)
    remarks += _of_delay_and_payload(family, scale, nominal)
    if family.kind == "current":
        remarks += _of_constants(scale, nominal)
        yield from _currents(family, scale)
    elif _is_of_joints(family, scale, nominal):
        remarks += _of_joint_torques(family, scale, nominal)
        yield from _joint_torques(family, scale, nominal)
    else:
        factors = motor_factors(family, scale, nominal)
        remarks += about_motor_torques(family, scale, nominal, factors)
        yield from motor_torques(family, scale, nominal, factors)


def _of_directions(scale: DriveScale, nominal: NominalDynamics) -> Iterator[str]:
    """Yield which angles are turned, and of which nobody can tell."""
    names, angles = np.array(nominal.bodies.names), scale.angles
    at_once = most_at_once(len(names))
    if at_once < len(names) and any(angles.turned[k] or sign_of(scale, k) < 0 for k in range(len(names))):
        number = "two" if at_once > 1 else "one"
        yield (
            f"of {len(names)} drives, angles that count the other way round were tried {number} at a time at most: "
            "where more are turned, signs below may be wrong; look at the robot"
        )
    if np.any(angles.turned):
        who = ", ".join(names[angles.turned])
        yield (
            f"{moved_by(nominal, angles.turned)} of {who} count the other way round than the model's: "
            "their factors are turned below"
        )
    if np.any(angles.beyond):
        yield (
            f"torques or currents would agree far better if {moved_by(nominal, angles.beyond)} of "
            f"{', '.join(names[angles.beyond])} counted the other way round, but then they would lie beyond the range "
            "that the robot has: left as they are. Either something carries load that the robot lacks (a spring, a "
            "cylinder, a counterweight), or zero and direction both differ: look at the robot"
        )
    slides = angles.alone & ~nominal.bodies.is_hinge
    for unsure, why in (
        (angles.unsure & ~slides, "an arm and its mirror image need the same"),
        (slides, "but for its weight it needs the same, and friction or an offset of the reading may be as large"),
    ):
        if np.any(unsure):
            yield (
                f"the direction of {', '.join(names[unsure])} is not told by torques ({why}): look at the robot; "
                f"{moved_by(nominal, unsure)} and torques or currents are turned together"
            )


def _of_delay_and_payload(family: Family, scale: DriveScale, nominal: NominalDynamics) -> Iterator[str]:
    """Yield against which payload readings were held, if it is told, and how late they are."""
    told = bool(np.any(scale.sigma <= UNTOLD))
    mass = f"{scale.payload:.3g} +- {scale.payload_sigma:.2g} kg" if scale.payload_sigma else "0 kg"
    payload = f" with {mass} of payload, with which all drives agree best" if told else ""
    yield (
        f"{family.shown}: held against the masses of the robot{payload}; they "
        f"{'lag' if scale.delay >= 0 else 'lead'} the angles by {1e3 * abs(scale.delay):.1f} +- "
        f"{1e3 * scale.delay_sigma:.1f} ms (what the model gets wrong of rotors and friction looks like that too)"
    )
    if told and 0 < nominal.payload <= scale.payload * (1 + AT_MOST):
        yield (
            "that is the largest payload that may be unstated: if more hangs there, raise payload_kg in figures.yaml; "
            "else its centre is elsewhere, or masses or rotors are wrong, and factors are not told well"
        )


def _currents(family: Family, scale: DriveScale) -> Iterator[Line]:
    for number, source, k in each_drive(family):
        sign = sign_of(scale, k)
        direction = "turned, it counts against the model's torque" if sign < 0 else "sign as the model has it"
        direction = direction if is_told(scale, k) else "this log does not tell its sign"
        why = f"{explained(scale, k)}; {direction}{unit_words(family)}"
        yield Line(f"current_{number}_a", source, sign * si_factor(family), 0.0, why)


def _of_constants(scale: DriveScale, nominal: NominalDynamics) -> Iterator[str]:
    """Yield the torque constants that figures do not state, and those that they state and the log contradicts."""
    names, constants = nominal.bodies.names, nominal.stated_constant
    missing = np.flatnonzero(~np.isfinite(constants)).tolist()
    told = [f"{names[k]} {estimate(scale, k)}" for k in missing if is_told(scale, k)]
    if told:
        yield f"for figures.yaml, torque_constant_nm_per_a as estimated: {', '.join(told)} (torque_constant_error)"
        worst = max(scale.sigma[k] for k in missing if is_told(scale, k))
        yield (
            f"write the error beside the constant of each drive too, such as `torque_constant_error: {worst:.2g}`: "
            "without it, 0.01 is taken, and intervals of masses and friction are too narrow"
        )
    if untold := [names[k] for k in missing if not is_told(scale, k)]:
        yield f"this log does not tell the torque constant of {', '.join(untold)}"
    yield from contradictions("torque_constant_nm_per_a", constants, scale, nominal)


def _is_of_joints(family: Family, scale: DriveScale, nominal: NominalDynamics) -> bool:
    """Return whether readings are torques at the joints: near to the model's, or in Nm and no gear ratio away from it.

    What is called a torque is one at the joint or one at the motor. The middle between both, on a logarithmic scale, is
    held against the mean of all drives, which counts those most that are told best. Torques that are smaller than
    what their names say have the unit of their names all the same. What has no name is one at the joint if the mean is
    near to the model's and no drive is surely off.
    """
    size = np.abs(scale.factor)
    if np.all(np.abs(size - 1)[scale.counts] < NEAR_ONE):
        return True
    if family.kind != "torque":
        return agree(scale, np.ones_like(size))
    ratio = nominal.gear_ratio
    slowest = np.log(np.where(np.isfinite(ratio) & (ratio > SLOWEST_GEAR), ratio, SLOWEST_GEAR))
    off, middle = mean_over_drives(np.log(size), scale), 0.5 * mean_over_drives(slowest, scale)
    return bool((off if family.unit else abs(off)) < middle)


def _joint_torques(family: Family, scale: DriveScale, nominal: NominalDynamics) -> Iterator[Line]:
    for number, source, k in each_drive(family):
        off = abs(abs(scale.factor[k]) - 1)
        near = f" within {100 * off:.0f} % of the model's" if off < NEAR_ONE else ""
        why = f"{explained(scale, k)}; joint torque{near}{unit_words(family)}"
        yield Line(torque_column(number, nominal), source, sign_of(scale, k) * si_factor(family), 0.0, why)


def _of_joint_torques(family: Family, scale: DriveScale, nominal: NominalDynamics) -> Iterator[str]:
    """Yield how the model's torques compare, where they are not near."""
    size = np.abs(scale.factor)
    if not np.any(np.abs(size - 1)[scale.counts] >= NEAR_ONE):
        return
    factors = ", ".join(f"{name} {estimate(scale, k)}" for k, name in enumerate(nominal.bodies.names))
    if mean_over_drives(np.log(size), scale) < -0.5 * np.log(SLOWEST_GEAR):
        yield (
            f"unit {family.unit} in the name of {family.shown} is used, but this log contradicts it. "
            f"Model by reading: {factors}"
        )
        return
    yield (
        f"{family.shown}: taken as torques at the joints, for they are no gear ratio away from the model's; on the "
        f"motor's side they need gear ratios as factors. Model by reading: {factors}"
    )


def moved_by(nominal: NominalDynamics, drives: NDArray[np.bool_]) -> str:
    """Return what is read of the way of some drives: angles of hinges, positions of slides."""
    hinges = nominal.bodies.is_hinge[drives]
    return " and ".join(word for word, there in (("angles", hinges), ("positions", ~hinges)) if np.any(there))
