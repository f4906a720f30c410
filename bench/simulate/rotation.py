"""The rotation experiment as a policy."""

from collections.abc import Iterator

import numpy as np

from bench.robot.folder import Robot
from bench.scenario.rotation import RotationPart
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.payload import bolt_on
from bench.simulate.policy import Array, Mark, Script, Sitting, Step


def rotation_sittings(scenario: RotationPart, robot: Robot) -> tuple[Sitting, ...]:
    """Return the rotation experiment: one sitting per payload, each at rest where its first traverse begins."""
    first = scenario.speeds_deg_per_s[0]
    start = _at(scenario, scenario.start_deg[scenario.joint - 1] - _ahead(scenario) * first * scenario.ramp_s / 2)
    return tuple(
        Sitting(start, rotation_policy(scenario, robot, start, mass), (bolt_on(mass),), payload_kg=mass)
        for mass in scenario.payloads_kg
    )


def rotation_policy(scenario: RotationPart, robot: Robot, start: Array, payload_kg: float) -> Iterator[Step]:
    """Yield the steps with one payload: at each speed there and back, `repeats` times, read all the way.

    Args:
        scenario: What to do.
        robot: The robot.
        start: Shape (n,) [rad], where it stands.
        payload_kg: For the names of the runs, such as "payload100-speed10-up"; later repeats end in "-2", "-3", ...
    """
    top_speed = scenario.move_speed * np.array([drive.speed_limit_rad_per_s for drive in robot.figures.drives])
    acceleration = float(np.deg2rad(scenario.acceleration_deg_per_s2))
    ends = (scenario.start_deg[scenario.joint - 1], scenario.end_deg)
    q = start
    for speed in scenario.speeds_deg_per_s:
        for repeat in range(1, scenario.repeats + 1):
            for first, last in (ends, ends[::-1]):
                way = "up" if last > first else "down"
                run = f"payload{payload_kg:g}-speed{speed:g}-{way}" + (f"-{repeat}" if repeat > 1 else "")
                angles = traverse_deg(first, last, speed, scenario.ramp_s)
                script = Script(q)
                yield from script.move(_at(scenario, angles[0]), top_speed, acceleration)
                yield from script.hold(scenario.settle_s)
                yield from script.say(f"{payload_kg:g} kg, {speed:g} deg/s, {way}")
                every = round(scenario.sample_period_s / CONTROL_PERIOD)
                for i, angle in enumerate(angles):
                    q = _at(scenario, angle)
                    yield Step(q, np.zeros(6), Mark(run) if i % every == 0 else None)


def traverse_deg(first: float, last: float, speed: float, ramp_s: float) -> Array:
    """Return the angle after each control period [deg]: full speed from `first` to `last`, ramps before and behind.

    The speed rises as 10 s^3 - 15 s^4 + 6 s^5: acceleration and jerk begin and end at zero and excite the arm little.

    Args:
        first: Where full speed is reached [deg].
        last: Where it ends [deg].
        speed: [deg/s].
        ramp_s: Duration of a ramp [s].
    """
    seconds = abs(last - first) / speed + 2 * ramp_s
    t = np.append(np.arange(0.0, seconds, CONTROL_PERIOD), seconds)
    begun, ended = np.clip(t / ramp_s, 0, 1), np.clip((t - seconds) / ramp_s + 1, 0, 1)
    plain = np.clip(t - ramp_s, 0, seconds - 2 * ramp_s)
    way = ramp_s * (_ramp(begun) + ended - _ramp(ended)) + plain
    angle: Array = first + np.sign(last - first) * speed * (way - ramp_s / 2)
    return angle


def _ramp(s: Array) -> Array:
    """Return the integral of 10 s^3 - 15 s^4 + 6 s^5."""
    return s**4 * (2.5 - 3 * s + s**2)


def _ahead(scenario: RotationPart) -> float:
    return float(np.sign(scenario.end_deg - scenario.start_deg[scenario.joint - 1]))


def _at(scenario: RotationPart, angle_deg: float) -> Array:
    q = np.array(scenario.start_deg)
    q[scenario.joint - 1] = angle_deg
    radians: Array = np.deg2rad(q)
    return radians
