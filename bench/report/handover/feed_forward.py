"""Feed-forward torques along a motion that a controller is going to command: a table, and what the torques are for."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.diagnose.replay.motion_segments import lowest_period
from bench.diagnose.replay.perfect_instruments import ideal_reading
from bench.diagnose.replay.resolution import LEAST_WINDOW
from bench.diagnose.replay.uneven_derivative import derivative_over
from bench.diagnose.replay.world import moved
from bench.effects.effect import Acting
from bench.errors import InputError
from bench.identify.arm import Arm
from bench.record import csv_table
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.plain_file import FileFault
from bench.report.handover.applied import Applied
from bench.report.handover.drag import drag_torque
from bench.report.handover.motion_faults import clock_faults, derivative_faults
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading
from bench.simulate.prescribed import Motion, Prescribed
from bench.simulate.trace import Trace

LEAST_ROWS = 3  # that a second derivative takes
PARTS = ("links", "rotor", "friction", "balance", "rest")


@dataclass(frozen=True, eq=False)
class FeedForward:
    """Motor torques along a motion; T instants, n drives.

    Attributes:
        torque: Shape (T, n) [Nm], of the motors at the joints.
        parts: Name -> shape (T, n) [Nm]; they add up to `torque`. `links`: rigid links, as a URDF has them, at the
            motor angles. `rotor`: J_m N^2 times the acceleration. `friction`: of both sides. `balance`: the
            counterbalance. `rest`: what the give of gears and passive hinges changes, and torques that were learned.
        shown: Columns of the campaign format -> shape (T,): what the drives will report, errors as fitted included.
        time: Shape (T,) [s].
    """

    time: Array
    torque: Array
    parts: dict[str, Array]
    shown: dict[str, Array]

    def columns(self, units: tuple[str, ...]) -> dict[str, Array]:
        """Return the table; `units` has "nm", or "n" of a slide, for each drive."""
        found = {"time_s": self.time}
        for name, values in (("torque", self.torque), *self.parts.items()):
            found |= {f"{name}_{j + 1}_{unit}": values[:, j] for j, unit in enumerate(units)}
        return found | self.shown


def _hint(missing: Sequence[str], columns: Mapping[str, Array]) -> str:
    """Return why a motion may lack columns, "" where nothing is known: a slide counts in m, a hinge in rad."""
    for name in missing:
        start, unit = name.rsplit("_", 1)
        other = f"{start}_{'rad' if unit == 'm' else 'm'}"
        if other in columns:
            return f"; it has {other}, but that joint is a {'slide, in m' if unit == 'm' else 'hinge, in rad'}"
    return "; a measured motion is none: its noise would be in the accelerations" if "time_s" in columns else ""


def read_motion(file: Path, compiled: CompiledRobot) -> Motion:
    """Read a motion to command.

    Columns: `time_s`; `q_cmd_i_rad` of each drive i from 1 (of a slide `q_cmd_i_m`); and, where the planner knows them,
    `velocity_i` [rad/s] and `acceleration_i` [rad/s^2] of all drives. Others are not read. Without them, derivatives
    are taken over three neighbouring rows, which is exact where the acceleration is constant between them.

    Raises:
        InputError: The file cannot be read, or lacks a column; times do not grow, or are hardly in seconds; angles
            leave the joints' ranges; or a derivative is one of something else.
    """
    findings: list[Finding] = []
    if not file.is_file():
        raise InputError(f"{file}: there is no such file; give a CSV file with time_s and q_cmd_i_rad.")
    try:
        content = csv_table.read(file, str(file), findings)
    except FileFault as fault:
        raise InputError(f"{file}: {fault}; {fault.remedy}.") from fault
    if findings or content is None:
        raise InputError(str(finding) for finding in findings)
    _, columns = content
    n = compiled.n_joints
    units = ["m" if slide else "rad" for slide in compiled.is_slide]
    names = [f"q_cmd_{j + 1}_{unit}" for j, unit in enumerate(units)]
    if missing := [name for name in ("time_s", *names) if name not in columns]:
        raise InputError(f"{file}: lacks {', '.join(missing)}{_hint(missing, columns)}.")
    time, q = columns["time_s"], np.stack([columns[name] for name in names], axis=1)
    problems = list(_faults(file, time, q, compiled, names))
    if problems:
        raise InputError(problems)
    if problems := [f"{file}: {words}" for words in clock_faults(time, q, compiled)]:
        raise InputError(problems)
    derivatives = []
    for kind in ("velocity", "acceleration"):
        given = [f"{kind}_{j + 1}" for j in range(n)]
        there = [name for name in given if name in columns]
        if there and len(there) < n:
            raise InputError(f"{file}: has {', '.join(there)} but not all of {', '.join(given)}.")
        derivatives.append(np.stack([columns[name] for name in there], axis=1) if there else None)
    velocity, acceleration = _derivatives(time, q)
    if derivatives[0] is not None:
        problems += derivative_faults("velocity", derivatives[0], velocity, compiled)
    if derivatives[1] is not None:
        problems += derivative_faults("acceleration", derivatives[1], acceleration, compiled)
    if problems:
        raise InputError(f"{file}: {words}" for words in problems)
    return Motion(
        time=time,
        q=q,
        velocity=velocity if derivatives[0] is None else derivatives[0],
        acceleration=acceleration if derivatives[1] is None else derivatives[1],
        wrench=np.zeros((len(time), 6)),
        read=np.ones(len(time), dtype=np.bool_),
    )


def feed_forward(applied: Applied, motion: Motion) -> FeedForward:
    """Return the torques that a motion takes: those of the bench's own model, as a replay has them.

    Friction elements begin unstressed and remember the way; what rings is left out. Gears wind up meanwhile, averaged
    over a period of the lowest mode: links do not follow what a command does faster than that.

    Args:
        applied: The robot.
        motion: Of its motors, as their encoders show it.

    Raises:
        ConvergenceError: The model finds no balance at some instant.
    """
    compiled, at = applied.compiled, applied.compiled.at
    motion, _ = moved(motion, applied.world)
    robot = Prescribed(compiled)
    trace, found, load = robot.follow(motion)
    speed, bend = _winding(compiled, motion, load / compiled.stiffness)
    trace, *_ = robot.follow(motion, found, (motion.velocity - speed, motion.acceleration - bend))
    arm = Arm(applied.bodies)
    rows = zip(motion.q, motion.velocity, motion.acceleration, strict=True)
    parts = {
        "links": np.array([arm.inverse_dynamics(*row) for row in rows]),
        "rotor": compiled.model.dof_armature[at.q_dof] * motion.acceleration,
        "friction": drag_torque(compiled, motion.velocity) - trace.motor_friction - trace.link_friction,
        "balance": np.zeros_like(motion.q),
    }
    balance = compiled.counterbalance
    if balance is not None:
        j = balance.joint
        parts["balance"][:, j] = trace.counterbalance_force * balance.lever_arm(trace.theta[:, j])
    parts["rest"] = trace.motor_torque - np.sum(list(parts.values()), axis=0)
    reading, shown = _shown(applied, trace), {}
    for j, slide in enumerate(compiled.is_slide):
        if compiled.robot.figures.instruments.current:
            shown[f"current_{j + 1}_a"] = reading.current[:, j]
        if compiled.robot.figures.instruments.torque:
            shown[f"tau_motor_{j + 1}_{'n' if slide else 'nm'}"] = reading.torque[:, j]
    return FeedForward(motion.time, trace.motor_torque, parts, shown)


def _shown(applied: Applied, trace: Trace) -> Reading:
    """Return what instruments show, with their errors."""

    def distorted(reading: Reading, acting: Sequence[Acting]) -> Reading:
        for one in acting:
            reading = one.effect.distort(one.place, one.values, reading, trace, applied.conditions)
        return reading

    return applied.world.read(ideal_reading(applied.compiled, trace), distorted)


def _winding(compiled: CompiledRobot, motion: Motion, wound: Array) -> tuple[Array, Array]:
    """Return first and second derivatives of how far gears are wound up, shape (T, n) each; none of short motions."""
    period = lowest_period(compiled, motion.q.mean(axis=0))
    window = max(LEAST_WINDOW, 2 * round(period / np.median(np.diff(motion.time)) / 2) + 1)
    if window > len(motion):
        return np.zeros_like(wound), np.zeros_like(wound)
    return derivative_over(wound, motion.time, window, 1), derivative_over(wound, motion.time, window, 2)


def _faults(file: Path, time: Array, q: Array, compiled: CompiledRobot, names: list[str]) -> Iterator[str]:
    if len(time) < LEAST_ROWS:
        yield f"{file}: has {len(time)} rows; give at least {LEAST_ROWS}."
        return
    if not (np.all(np.isfinite(time)) and np.all(np.diff(time) > 0)):
        yield f"{file}: time_s: has to grow from row to row."
    for j, name in enumerate(names):
        low, high = compiled.limits[j]
        wrong = np.flatnonzero(~((q[:, j] >= low) & (q[:, j] <= high)))
        if len(wrong) and compiled.model.jnt_limited[compiled.at.joint[j]]:
            yield f"{file}: row {wrong[0] + 1}: {name}: {q[wrong[0], j]:g} is outside of {low:g} to {high:g}."
        elif not np.all(np.isfinite(q[:, j])):
            yield f"{file}: {name}: is not a number in some rows."


def _derivatives(time: Array, q: Array) -> tuple[Array, Array]:
    """Return velocity and acceleration of the parabola through each row and its neighbours, shape (T, n) each."""
    velocity = np.gradient(q, time, axis=0, edge_order=2)
    slope = np.diff(q, axis=0) / np.diff(time)[:, None]
    inner = 2 * np.diff(slope, axis=0) / (time[2:] - time[:-2])[:, None]
    return velocity, np.concatenate([inner[:1], inner, inner[-1:]])
