"""Noise that a campaign or a robot states of its instruments, held against how their readings scatter.

A bench takes what is stated: noise in millimetres explains everything that a tracker in metres can read.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bench.diagnose.plausibility.channels import BEYOND_GUESS
from bench.diagnose.replay.noise import FEWEST, UNIFORM, Noise
from bench.diagnose.replay.resolution import step_of
from bench.record.campaign import Array, Campaign
from bench.record.channels import columns_of
from bench.record.finding import Finding
from bench.record.manifest import MANIFEST
from bench.record.rules.labels import STATE
from bench.robot.folder import FIGURES_FILE, Robot

# Times what readings scatter: nearer, on a logarithmic scale, to what another unit would make of it (mA, mm) than to 1.
# Accuracy that is stated for repeatability is ten times as much with good instruments.
FAR = BEYOND_GUESS["torque limit"]

ROUNDED = 3.0  # declared: times the noise of a tracker, that rounding alone scatters


class _Stated(NamedTuple):
    """A standard deviation of single readings as stated: file and key, channels (of one drive or all), and value."""

    file: str
    key: str
    quantity: str
    drive: int | None
    value: float


def noise_as_stated(campaign: Campaign, robot: Robot) -> Iterator[Finding]:
    """Yield a warning for each noise that was stated far from how its channels scatter in the median run.

    Args:
        campaign: A checked campaign.
        robot: Its robot; what its figures state counts where the campaign states nothing, and where it is too much.
    """
    of_robot = [one for one in _of_figures(robot) if one.quantity not in campaign.noise]
    of_campaign = [_Stated(MANIFEST, f"noise.{name}", name, None, value) for name, value in campaign.noise.items()]
    for stated in (*of_campaign, *of_robot):
        scatters = [
            _scatter(run.kind == "static", run.columns[column.name], labels)
            for run in campaign.runs
            for labels in [[run.columns[name] for name in STATE if name in run.columns]]
            for column in columns_of(run.columns, stated.quantity)
            if stated.drive in (None, column.index)
        ]
        known = [one for one in scatters if one > 0]
        if not known:
            continue
        least, usual = min(known), float(np.median(known))  # an arm that sways scatters by more than its instruments
        if stated.value > FAR * usual:
            how = f"{stated.value / usual:.2g} times as much as its readings scatter ({usual:.2g})"
        elif FAR * stated.value < least and stated.file == MANIFEST:
            how = f"{least / stated.value:.2g} times less than any of its readings scatter ({least:.2g})"
        else:
            continue
        message = f"{stated.value:g} is {how}"
        remedy = "milli or kilo? noise is in the unit of the column: A, Nm, N, m, rad, Pa"
        yield Finding("warning", stated.file, None, stated.key, message, remedy)


def coarse_encoders(campaign: Campaign, robot: Robot) -> Iterator[Finding]:
    """Yield a warning for each encoder whose readings go in steps far above its resolution as the figures state it.

    Args:
        campaign: A checked campaign.
        robot: Its robot.
    """
    instruments = robot.figures.instruments
    for quantity, encoder in (("q_motor", instruments.encoder), ("q_link", instruments.link_encoder)):
        if encoder is None:
            continue
        steps: dict[str, list[float]] = {}
        for run in campaign.of_kind("motion"):
            for column in columns_of(run.columns, quantity):
                steps.setdefault(column.name, []).append(step_of(run.columns[column.name]))
        for name, seen in steps.items():
            usual = float(np.median(seen))
            if usual > FAR * encoder.resolution_rad:
                key = f"instruments.{'encoder' if quantity == 'q_motor' else 'link_encoder'}.resolution_rad"
                message = f"reads in steps of {usual:.3g}, {usual / encoder.resolution_rad:.2g} times {key}"
                remedy = f"rounded? log all digits; else the encoder is as coarse: write that into {FIGURES_FILE}"
                yield Finding("warning", "all runs", None, name, message, remedy)


def rounded_places(campaign: Campaign, robot: Robot) -> Iterator[Finding]:
    """Yield a warning for each coordinate of a reflector that was rounded far more coarsely than its tracker scatters.

    Args:
        campaign: A checked campaign.
        robot: Its robot.
    """
    tracker = robot.figures.instruments.tracker
    if tracker is None:
        return
    for column in dict.fromkeys(one for run in campaign.runs for one in columns_of(run.columns, "reflector")):
        runs = [run for run in campaign.runs if column.name in run.columns]
        step = step_of(np.concatenate([run.columns[column.name] for run in runs]))
        axes = [f"reflector_{column.index}_{axis}_m" for axis in "xyz"]
        places = [np.stack([run.columns[name] for name in axes], axis=1) for run in runs if {*axes} <= {*run.columns}]
        away = np.linalg.norm(np.concatenate(places) - tracker.position_m, axis=1) if places else np.zeros(1)
        sigma = campaign.noise.get("reflector", tracker.sigma_per_distance * float(np.median(away)))
        if sigma > 0 and UNIFORM * step > ROUNDED * sigma:
            message = f"reads in steps of {step:.3g} m, {step / sigma:.0f} times the noise of the tracker as stated"
            yield Finding("warning", "all runs", None, column.name, message, "rounded? log all digits")


def _of_figures(robot: Robot) -> Iterator[_Stated]:
    """Yield what figures state of sensors of drives and loads; a default that nobody looked at says nothing."""
    instruments, file = robot.figures.instruments, f"{robot.folder.name}/{FIGURES_FILE}"
    for name, sensor, kinds in (
        ("current", instruments.current, {"sigma_a": "current"}),
        ("force", instruments.force, {"sigma_n": "force", "sigma_nm": "moment"}),
    ):
        for key, quantity in kinds.items():
            if sensor is not None and key in sensor.model_fields_set:
                yield _Stated(file, f"instruments.{name}.{key}", quantity, None, getattr(sensor, key))
    if instruments.torque:
        each = instruments.torque.sigma_of(robot.n_joints)
        for i, value in enumerate(each, start=1):
            yield _Stated(file, "instruments.torque.sigma_nm", "tau_motor", i, value)


def _scatter(is_static: bool, values: Array, labels: list[Array]) -> float:
    """Return the standard deviation of one reading, rounding included; 0 where nobody can say.

    Args:
        is_static: Whether rows are readings at rest; then repeats of a state tell, else neighbours.
        values: Shape (n,).
        labels: Of states, shape (n,) each.
    """
    steps = np.abs(np.diff(values))
    if len(values) < FEWEST or not np.any(steps > 0):
        return 0.0
    rounding = UNIFORM * float(steps[steps > 0].min())
    if not is_static:
        return float(np.hypot(Noise.of_samples(values[:, None])[0], rounding))
    states = np.unique(np.stack([*labels, 0 * values]), axis=1, return_inverse=True)[1]
    rests = [values[states == state] for state in range(states.max() + 1)]
    variances = [float(np.var(rest, ddof=1)) for rest in rests if len(rest) > 1]
    return float(np.hypot(np.sqrt(np.median(variances)), rounding)) if variances else 0.0
