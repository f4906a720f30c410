"""The line experiment as a policy."""

from collections.abc import Iterator

import numpy as np
from scipy.interpolate import CubicSpline

from bench.robot.compiled import compile_robot
from bench.robot.folder import Robot
from bench.robot.line_path import JointPath
from bench.robot.links import rigid_bodies
from bench.scenario.line import Corrections, LinePart
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.policy import Array, Mark, Script, Sitting, Step

RETURN_SPEED = 0.05  # [rad/s], of the small moves from the corrections of one pass to those of the next


def line_sittings(scenario: LinePart, robot: Robot) -> tuple[Sitting, ...]:
    """Return the line experiment: one sitting that begins at rest, unloaded, where the first lead-in begins."""
    path = scenario.path(rigid_bodies(compile_robot(robot)))
    start = _angles(scenario, path, lead_in_start(scenario)[None], is_out=True)[0]
    return (Sitting(start, line_policy(scenario, path, start)),)


def line_policy(scenario: LinePart, path: JointPath, start: Array) -> Iterator[Step]:
    """Yield the steps of the line experiment: runs `unloaded-out`, `unloaded-back`, `loaded-out`, `loaded-back`.

    Every run has one row per sample, from one end of the line to the other, at constant speed, both ends included. So
    row i of a run out and row i from the end of a run back have the same place on the line, and a friction that
    slides.

    Args:
        scenario: What to do.
        path: Joint angles along the line.
        start: Shape (n,) [rad], where the robot stands.
    """
    hanging = np.concatenate([scenario.force_n * _unit(scenario.direction), np.zeros(3)])
    script = Script(start)
    for state, wrench in (("unloaded", np.zeros(6)), ("loaded", hanging)):
        if state == "unloaded" and not scenario.unloaded:
            continue
        if np.any(wrench):
            yield from script.push(wrench, scenario.load_ramp_s)
        for way in ("out", "back"):
            distance = pass_distance(scenario)
            first = lead_in_start(scenario)
            if way == "back":
                distance, first = path.length - distance, path.length - first
            angles = _angles(scenario, path, np.append(first, distance), way == "out")
            yield from script.move(angles[0], RETURN_SPEED)
            yield from script.hold(scenario.settle_s)
            yield from script.say(f"{state}, {way}")
            yield from script.follow(angles[1:], dict.fromkeys(read_periods(scenario), Mark(f"{state}-{way}")))
    yield from script.push(np.zeros(6), scenario.load_ramp_s)


def pass_distance(scenario: LinePart) -> Array:
    """Return the distance from the start of the line after each control period of one pass out, shape (T,) [m].

    The speed rises as 10 s^3 - 15 s^4 + 6 s^5 over half the lead-in, stays for its other half, over the line, and as
    long behind it, and falls in the same way.
    """
    half = _half_lead_in(scenario)
    step = scenario.speed_m_per_s * CONTROL_PERIOD
    rising = lead_in_start(scenario) + half * step * _ramp(np.arange(1, half + 1) / half)
    steady = step * np.arange(1 - half, _periods_on_line(scenario) + half + 1)
    falling = scenario.length_m - np.append(rising[-2::-1], lead_in_start(scenario))
    return np.concatenate([rising, steady, falling])


def lead_in_start(scenario: LinePart) -> Array:
    """Return where the lead-in begins, as a distance from the start of the line, scalar [m]; negative."""
    return np.array(-1.5 * _half_lead_in(scenario) * scenario.speed_m_per_s * CONTROL_PERIOD)


def read_periods(scenario: LinePart) -> range:
    """Return the control periods of a pass at whose ends is read, from one end of the line to the other."""
    first = 2 * _half_lead_in(scenario) - 1
    every = round(scenario.sample_period_s / CONTROL_PERIOD)
    return range(first, first + _periods_on_line(scenario) + 1, every)


def _angles(scenario: LinePart, path: JointPath, distance: Array, is_out: bool) -> Array:
    angles = path.at(distance)
    if scenario.corrections:
        angles = angles + corrections_at(scenario.corrections, distance / path.length, is_out)
    return angles


def corrections_at(corrections: Corrections, share: Array, is_out: bool) -> Array:
    """Return corrections at shares of the line, shape (T,), as (T, n) [rad]; beyond the ends those of the ends."""
    knots = np.array(corrections.out_rad if is_out else corrections.back_rad)
    return np.asarray(CubicSpline(corrections.share, knots)(np.clip(share, 0.0, 1.0)))


def _half_lead_in(scenario: LinePart) -> int:
    return int(np.ceil(scenario.lead_in_s / 2 / CONTROL_PERIOD))


def _periods_on_line(scenario: LinePart) -> int:
    return round(scenario.length_m / (scenario.speed_m_per_s * CONTROL_PERIOD))


def _ramp(s: Array) -> Array:
    """Return the integral of 10 s^3 - 15 s^4 + 6 s^5."""
    return s**4 * (2.5 - 3 * s + s**2)


def _unit(direction: tuple[float, float, float]) -> Array:
    return np.asarray(np.array(direction) / np.linalg.norm(direction))
