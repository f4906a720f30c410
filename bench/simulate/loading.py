"""The loading experiment as a policy."""

from collections.abc import Iterator

import numpy as np

from bench.robot.folder import Robot
from bench.scenario.loading import LoadedPose, LoadingPart
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.policy import Array, Mark, Script, Sitting, Step

_SIDES = {False: {1: "below", -1: "above"}, True: {1: "own-sides", -1: "other-sides"}}


def loading_sittings(scenario: LoadingPart, robot: Robot) -> tuple[Sitting, ...]:
    """Return the loading experiment: one sitting that begins at the start of the first approach."""
    first = scenario.poses[0]
    start = np.deg2rad(np.array(first.q_deg) - first.side(scenario.approach[0]) * scenario.approach_deg)
    return (Sitting(start, loading_policy(scenario, robot, start)),)


def loading_policy(scenario: LoadingPart, robot: Robot, start: Array) -> Iterator[Step]:
    """Yield the steps of the loading experiment.

    For each pose and each approach direction: go to a point `approach_deg` short of the pose in every joint, approach
        it slowly from there, so that every joint's friction points the same known way; read unloaded; then load step by
        step, reading at each; then, with `unload`, take the loads off in the same steps, reading at each, the last
        unloaded.
    """
    top_speed = scenario.move_speed * np.array([drive.speed_limit_rad_per_s for drive in robot.figures.drives])
    acceleration = float(np.deg2rad(scenario.acceleration_deg_per_s2))
    script = Script(start)
    for i, pose in enumerate(scenario.poses, start=1):
        q = np.deg2rad(pose.q_deg)
        for sign in scenario.approach:
            side = _SIDES[bool(pose.sides)][sign]
            run = f"pose{i}-from-{side}"
            yield from script.move(q - pose.side(sign) * np.deg2rad(scenario.approach_deg), top_speed, acceleration)
            yield from script.move(q, np.deg2rad(scenario.approach_speed_deg_per_s), acceleration)
            yield from script.hold(scenario.settle_s)
            for k, wrench in enumerate(load_steps(pose, scenario.unload)):
                yield from script.say(f"pose {i}, from {side}, {np.linalg.norm(wrench[:3]):.0f} N")
                if k > 0:
                    yield from script.push(wrench, scenario.load_ramp_s)
                    yield from script.hold(scenario.settle_s)
                labels = {"pose": float(i), "load_step": float(k)}
                if not pose.sides:  # the label is one side for all joints
                    labels["approach"] = float(sign)
                for repeat in range(1, scenario.repeats + 1):
                    yield from script.hold(scenario.repeat_interval_s - CONTROL_PERIOD)
                    mark = Mark(run, labels | {"repeat": float(repeat)})
                    yield from script.read(mark, move_reflector=scenario.orientation and repeat == 1)
            yield from script.push(np.zeros(6), scenario.load_ramp_s)


def load_steps(pose: LoadedPose, unload: bool) -> list[Array]:
    """Return the wrenches of one series, each shape (6,) [N, Nm]: none, up through all, and down again to none."""
    direction = np.array(pose.direction) / np.linalg.norm(pose.direction)
    up = [0.0, *pose.force_n]
    forces = up + up[-2::-1] if unload else up
    return [np.concatenate([force * direction, np.zeros(3)]) for force in forces]
