"""From readings to the columns of a campaign's runs."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from bench.record.campaign import Run
from bench.robot.compiled import CompiledRobot
from bench.simulate.drive import Log
from bench.simulate.instruments import Reading
from bench.simulate.trace import Array, Trace


@dataclass(frozen=True)
class Joints:
    """What the names of a robot's columns depend on.

    Attributes:
        is_slide: One for each drive; a joint that is not a slide is a hinge.
        has_link_encoder: One for each drive.
    """

    is_slide: tuple[bool, ...]
    has_link_encoder: tuple[bool, ...]

    @classmethod
    def of(cls, compiled: CompiledRobot) -> Self:
        """Return those of a robot."""
        encoder = compiled.robot.figures.instruments.link_encoder
        fitted = encoder.joints if encoder else ()
        return cls(compiled.is_slide, tuple(drive.joint in fitted for drive in compiled.robot.figures.drives))


def run_of(name: str, log: Log, reading: Reading, gravity: Array, with_moving_reflector: bool, joints: Joints) -> Run:
    """Return one run of a session.

    Args:
        name: Which.
        log: What happened.
        reading: What was read at every marked step of the log, by real or by ideal instruments.
        gravity: Shape (3,) [m/s^2].
        with_moving_reflector: Whether a reflector was carried round the other nests; else they stayed empty.
        joints: Which joints slide, and which have a secondary encoder.
    """
    rows = log.rows(name)
    start = float(reading.time[rows[0]])
    columns: dict[str, Array] = {"time_s": reading.time[rows] - start}
    marks = [step.mark for step in (log.steps[i] for i in rows) if step.mark]
    for label in marks[0].labels:
        columns[label] = np.array([mark.labels[label] for mark in marks])
    payload = np.array([log.payload_kg[i] for i in rows])
    load = np.stack([log.steps[i].wrench for i in rows])
    load[:, :3] += payload[:, None] * gravity
    columns |= _columns(reading[rows], np.stack([log.steps[i].q_cmd for i in rows]), load, joints)
    if np.any(payload):  # bolted to the arm; the force sensor sits at the hook and does not feel it
        columns = {key: values for key, values in columns.items() if not key.startswith(("force_", "moment_"))}
        columns["load_mass_kg"] = payload
    if not with_moving_reflector:
        columns = {key: values for key, values in columns.items() if not key.startswith("reflector_") or key[10] == "1"}
    return Run(name, "static" if marks[0].labels else "motion", start, columns)


def with_link_angles(run: Run, log: Log, instants: Trace) -> Run:
    """Return a run with the true link angles beside the other columns."""
    theta = instants.theta[log.rows(run.name)]
    is_slide = tuple(f"q_cmd_{j}_m" in run.columns for j in range(1, theta.shape[1] + 1))
    return replace(run, columns={**run.columns, **_numbered("q_link", ("rad", "m"), theta, is_slide)})


def _columns(reading: Reading, q_cmd: Array, load: Array, joints: Joints) -> dict[str, Array]:
    """Return the columns of a reading, T instants; quantities without an instrument are left out.

    Args:
        reading: T instants.
        q_cmd: Shape (T, n) [rad].
        load: Shape (T, 6) [N, Nm], what hangs at the load point as the lab knows it from its weights.
        joints: Which joints slide, and which have a secondary encoder.
    """
    slides, angle = joints.is_slide, ("rad", "m")
    columns = _numbered("q_cmd", angle, q_cmd, slides) | _numbered("q_motor", angle, reading.q_motor, slides)
    columns |= _numbered("q_link", angle, np.where(joints.has_link_encoder, reading.q_link, np.nan), slides)
    columns |= _numbered("current", ("a", "a"), reading.current, slides)
    columns |= _numbered("tau_motor", ("nm", "n"), reading.torque, slides)
    columns |= _along("load", "n", load[:, :3]) | _along("force", "n", reading.force)
    columns |= _along("moment", "nm", reading.moment)
    for k in range(reading.reflectors.shape[1]):
        columns |= _along(f"reflector_{k + 1}", "m", reading.reflectors[:, k])
    columns["gas_pressure_pa"] = reading.gas_pressure
    return {name: values for name, values in columns.items() if not np.all(np.isnan(values))}


def _along(quantity: str, unit: str, values: Array) -> dict[str, Array]:
    return {f"{quantity}_{axis}_{unit}": column for axis, column in zip("xyz", values.T, strict=True)}


def _numbered(quantity: str, units: tuple[str, str], values: Array, is_slide: tuple[bool, ...]) -> dict[str, Array]:
    """Name one column per drive; `units` are those of a hinge and of a slide."""
    columns = zip(values.T, is_slide, strict=True)
    return {f"{quantity}_{j}_{units[slides]}": column for j, (column, slides) in enumerate(columns, start=1)}
