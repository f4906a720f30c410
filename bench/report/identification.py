"""Stiffness from a campaign by every method that its channels allow, as table and as JSON."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from bench.errors import ConvergenceError, InputError
from bench.identify.arm import Arm
from bench.identify.estimate import JointEstimate, StiffnessEstimate
from bench.identify.from_campaign import static_readings
from bench.identify.methods import METHODS
from bench.identify.options import Options
from bench.identify.weights_by_drives import WEIGH, weights_by_drives
from bench.record.campaign import Campaign
from bench.report.jsonable import to_jsonable
from bench.report.tables import print_wide, terminal
from bench.robot.compiled import CompiledRobot
from bench.robot.links import rigid_bodies

DEFAULTS = Options()
MNM = 1e6  # [Nm/rad] per 10^6 Nm/rad, the unit of Table 6
KNM = 1e3  # the unit of arms none of whose joints has a tenth of that


@dataclass(frozen=True)
class Identification:
    """What the methods say about one campaign.

    Attributes:
        campaign: Its folder.
        estimates: Method -> estimate.
        refused: Method -> why it could not be used on this campaign.
        remarks: On the campaign, whatever the method; one sentence each.
    """

    campaign: Path
    estimates: Mapping[str, StiffnessEstimate]
    refused: Mapping[str, str]
    remarks: tuple[str, ...] = ()


def identify_campaign(
    folder: Path,
    campaign: Campaign,
    compiled: CompiledRobot,
    methods: Iterable[str] | None = None,
    options: Options = DEFAULTS,
    among_loaded: bool = False,
) -> Identification:
    """Identify the stiffness from the static runs of a campaign.

    Args:
        folder: Where the campaign was read.
        campaign: A usable campaign.
        compiled: Its robot.
        methods: Names of methods; None takes every one and notes which the campaign has not the channels for.
        options: Of the methods.
        among_loaded: Loaded readings of a visit are held against its first load, not against the unloaded reading.

    Raises:
        InputError: A method that was asked for by name lacks a channel, or no pose was read under two loads.
        ConvergenceError: A method that was asked for by name does not settle.
    """
    arm = Arm(rigid_bodies(compiled))
    readings = static_readings(campaign, compiled.robot.figures)
    if among_loaded:
        readings = readings.among_loaded()
    estimates, refused = {}, {}
    with threadpool_limits(1, "blas"):  # the matrices are small: threads cost five times what they give
        for name in METHODS if methods is None else methods:
            try:
                estimates[name] = METHODS[name](arm, compiled.counterbalance, readings, options)
            except (InputError, ConvergenceError) as error:
                if methods is not None:
                    raise
                refused[name] = str(error)
        weights = weights_by_drives(arm, compiled.counterbalance, readings, compiled.robot.figures.uncertainty.load)
    remarks = (f"{weights.words}; {WEIGH}.",) if weights and weights.are_wrong else ()
    return Identification(folder, estimates, refused, remarks)


def as_json(estimate: StiffnessEstimate, level: float = 0.95) -> dict[str, object]:
    """Return an estimate as plain data, units in the keys; what is undefined is null."""
    content: dict[str, object] = {
        "method": estimate.method,
        "joints": list(estimate.joint_names),
        "stiffness_nm_per_rad": to_jsonable(estimate.stiffness),
        "standard_error_nm_per_rad": to_jsonable(estimate.standard_error),
        "interval_level": level,
        "interval_nm_per_rad": to_jsonable(estimate.interval(level)),
        "compliance_rad_per_nm": to_jsonable(estimate.compliance),
        "compliance_covariance_rad2_per_nm2": to_jsonable(estimate.covariance),
        "observable": [bool(seen) for seen in estimate.observable],
        "condition_number": to_jsonable(estimate.condition_number),
        "residual_rms_in_sigma": {
            channel: to_jsonable(np.sqrt(np.mean(np.square(values)))) for channel, values in estimate.residuals.items()
        },
        "notes": list(estimate.notes),
    }
    if isinstance(estimate, JointEstimate):
        content["link_side_share_of_friction"] = to_jsonable(estimate.link_share)
        content["link_side_share_sigma"] = to_jsonable(estimate.link_share_sigma)
    return content


def print_json(result: Identification, level: float) -> None:
    """Print the estimates as JSON."""
    content = {name: as_json(estimate, level) for name, estimate in result.estimates.items()}
    found = {"campaign": str(result.campaign), "estimates": content, "refused": dict(result.refused)}
    found["remarks"] = list(result.remarks)
    print(json.dumps(found, indent=2))


def print_table(result: Identification, level: float) -> None:
    """Print the estimates as a table, then what they cannot tell."""
    from rich.table import Table

    first = next(iter(result.estimates.values()))
    stiffness = np.concatenate([np.abs(estimate.stiffness) for estimate in result.estimates.values()])
    unit = KNM if np.nanmax(stiffness, initial=0.0) < 0.1 * MNM else MNM
    table = Table(title=f"joint stiffness [10^{np.log10(unit):.0f} Nm/rad], {level:.0%} intervals")
    table.add_column("method", no_wrap=True)
    for name in first.joint_names:
        table.add_column(name, justify="right")
    for name, estimate in result.estimates.items():
        table.add_row(name, *cells(estimate, level, unit))
    console = terminal()
    print_wide(console, table)
    for name, estimate in result.estimates.items():
        for note in estimate.notes:
            console.print(f"{name}: {note}", highlight=False)
    for remark in result.remarks:
        console.print(remark, highlight=False)
    for name, reason in result.refused.items():
        console.print(f"{name}: not used: {reason}", highlight=False)


def cells(estimate: StiffnessEstimate, level: float, unit: float) -> list[str]:
    """Return one cell per joint: value and interval in a unit [Nm/rad]."""
    return [
        "cannot tell" if np.isnan(value) else f"{value / unit:.3f}\n{low / unit:.3f} to {high / unit:.3f}"
        for value, (low, high) in zip(estimate.stiffness, estimate.interval(level), strict=True)
    ]
