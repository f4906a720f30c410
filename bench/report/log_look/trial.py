"""What `bench convert` and `bench check` would say of a proposed `log.yaml`."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bench.errors import InputError
from bench.identify.dynamics.turned import turned_axis
from bench.record.campaign import Arm, Campaign
from bench.record.convert import convert
from bench.record.log_format import LOG_FORMAT, read_log_format
from bench.record.rules.scale import angles
from bench.record.rules.sheet import Sheet
from bench.robot.nominal_dynamics import NominalDynamics


def refusals(file: Path, proposed: str, nominal: NominalDynamics | None) -> Iterator[str]:
    """Yield each reason for which a proposal is refused, or its angles are doubted, when it is applied to its log.

    Args:
        file: The log.
        proposed: Text of the `log.yaml`.
        nominal: The robot, if it is known.
    """
    try:
        with TemporaryDirectory() as folder:
            (written := Path(folder) / LOG_FORMAT).write_text(proposed, encoding="utf-8")
            layout = read_log_format(written)
        converted = convert(file, layout, "robot")
    except InputError as error:
        yield from (f"bench convert will refuse this as it stands: {problem}" for problem in error.problems)
        return
    if nominal is None:
        return
    arm = _arm(nominal)
    doubted = False
    for run in converted.campaign.runs:
        for finding in angles(Sheet(run, file.name, tuple(run.columns), arm)):
            doubted = True
            yield f"bench check will doubt this as it stands: {finding}"
    if not doubted:
        yield from _turned(converted.campaign, nominal)


def _turned(campaign: Campaign, nominal: NominalDynamics) -> Iterator[str]:
    """Yield the axis that is turned, in angle and torque alike or in angle alone, whatever links weigh.

    Drives share links, so their torques have to be in one unit: a current without a stated constant says nothing here.
    """
    try:
        turned = turned_axis(campaign, replace(nominal, torque_constant=nominal.stated_constant))
    except InputError:  # nothing moves for long enough, or no drive says what it paid
        return
    if turned:
        axes = " or ".join(f"axis {j + 1}" for j in turned.indices)
        model = "its weight, friction and the stated offset leave" if turned.bounded else "a linear model leaves"
        how = "its angle alone" if turned.alone else "angle and torque or current alike"
        back = "the factor of its angle" if turned.alone else "the factors of both"
        yield (
            f"{axes} seems to count the other way round than the model's, {how}: with {back} turned, {model} "
            f"{turned.after:.3g} of drive {turned.drive + 1} instead of {turned.before:.3g}"
        )


def _arm(nominal: NominalDynamics) -> Arm:
    ends = nominal.bodies.limits
    ends = np.where(ends[:, 1:] > ends[:, :1], ends, [-np.inf, np.inf])
    ratios = tuple(float(ratio) if np.isfinite(ratio) else None for ratio in nominal.gear_ratio)
    return Arm(
        tuple(not bool(hinge) for hinge in nominal.bodies.is_hinge),
        tuple((float(a), float(b)) for a, b in ends),
        ratios,
    )
