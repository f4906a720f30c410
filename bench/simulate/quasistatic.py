"""A session without time: the same policy, but only its rests, each found as an equilibrium. A hundred times faster.

What is left out against `bench.simulate.session`: everything that moves. Friction is rate independent here, and the
ringing after a load step, which shakes friction loose, does not happen; a servo with integral action rests exactly at
its command and never moved while the load came on. Noise, instruments and identification are the same.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.loading import Loading
from bench.simulate.drive import Log
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.equilibrium import Equilibrium
from bench.simulate.instruments import Instruments, Reading
from bench.simulate.loading import loading_sittings
from bench.simulate.policy import Step
from bench.simulate.session import edits_of
from bench.simulate.tables import Joints, run_of
from bench.simulate.trace import Array, Trace, gas_force

# A rest does not depend on how long the way there took; with these the policy takes one step for each move.
HURRY = {
    "move_speed": 1e6,
    "acceleration_deg_per_s2": 1e12,
    "approach_speed_deg_per_s": 1e9,
    "load_ramp_s": CONTROL_PERIOD,
    "settle_s": 0.0,
    "repeat_interval_s": CONTROL_PERIOD,
}


class RestLog:
    """The truth at every rest that is read; to be read by instruments as often as one likes.

    Attributes:
        compiled: The robot.
        log: The steps that are read.
        instants: The truth there.
    """

    def __init__(self, compiled: CompiledRobot, rests: Iterable[Step], start: Array) -> None:
        self.compiled = compiled
        equilibrium = Equilibrium(compiled)
        equilibrium.data.qpos[compiled.at.theta] = equilibrium.data.qpos[compiled.at.q] = start
        equilibrium = Equilibrium(compiled, equilibrium.data)
        equilibrium.solve(start, np.zeros(6))  # friction elements begin here, unstressed
        steps, instants = [], []
        for time, step in enumerate(rests):
            equilibrium.solve(step.q_cmd, step.wrench)
            if step.mark:
                steps.append(step)
                instants.append(_instant(equilibrium, step, float(time)))
        self.log = Log(steps=steps, payload_kg=[0.0] * len(steps))
        self.instants = Trace.concatenate(instants)

    def read(self, rng: np.random.Generator | None) -> Campaign:
        """Return the campaign that instruments of this seed would give; None: ideal instruments."""
        instruments = Instruments(self.compiled, rng)
        carried = any(step.move_reflector for step in self.log.steps)
        reading = self._read(instruments) if carried else instruments.read(self.instants)
        gravity = self.compiled.model.opt.gravity
        joints = Joints.of(self.compiled)
        runs = tuple(run_of(name, self.log, reading, gravity, carried, joints) for name in self.log.run_names)
        return Campaign(self.compiled.robot.name, runs)

    def _read(self, instruments: Instruments) -> Reading:
        parts = []
        for i, step in enumerate(self.log.steps):
            if step.move_reflector:
                instruments.move_reflector()
            parts.append(instruments.read(self.instants[i : i + 1]))
        return Reading.concatenate(parts)


def rest_log(scenario: Loading) -> RestLog:
    """Return the rests of a loading scenario on the virtual robot.

    Raises:
        InputError: The scenario does not fit the robot.
    """
    return rests_of(scenario, compile_robot(load_robot(scenario.robot), edits_of(scenario)))


def rests_of(scenario: Loading, compiled: CompiledRobot) -> RestLog:
    """Return the rests of a loading scenario on a robot as compiled; the scenario's friction and servo are not used.

    Raises:
        InputError: The scenario does not fit the robot.
    """
    scenario.check(compiled.robot, compiled.limits)
    (sitting,) = loading_sittings(scenario.model_copy(update=HURRY), compiled.robot)
    return RestLog(compiled, turning_points(sitting.steps), sitting.start)


def turning_points(steps: Iterable[Step]) -> list[Step]:
    """Return the steps that are read, and those after which a command or a load changes its direction.

    Nothing in between matters to what is rate independent.
    """
    kept: list[Step] = []
    before: Step | None = None
    direction: Array | None = None
    for step in steps:
        if before is not None:
            way = np.sign(np.concatenate([step.q_cmd - before.q_cmd, step.wrench - before.wrench]))
            turns = direction is not None and np.any(way * direction < 0)
            stops = direction is not None and np.any(direction) and not np.any(way)
            if (turns or stops) and (not kept or kept[-1] is not before):
                kept.append(replace(before, mark=None))
            direction = way
        if step.mark:
            kept.append(step)
        before = step
    return kept


def _instant(equilibrium: Equilibrium, step: Step, time: float) -> Trace:
    compiled, data = equilibrium.compiled, equilibrium.data
    at = compiled.at
    zero = np.zeros((1, compiled.n_joints))
    has_cylinder = at.counterbalance >= 0
    pull = np.array([-data.actuator_force[at.counterbalance] if has_cylinder else np.nan])
    length = np.array([data.ten_length[at.counterbalance_tendon] if has_cylinder else np.nan])
    return Trace(
        time=np.array([time]),
        q=data.qpos[None, at.q].copy(),
        q_velocity=zero,
        theta=data.qpos[None, at.theta].copy(),
        theta_velocity=zero,
        motor_torque=equilibrium.motor_torque()[None],
        motor_friction=data.actuator_force[None, at.motor_friction].copy(),
        link_friction=data.actuator_force[None, at.link_friction].copy(),
        reflectors=data.site_xpos[None, at.reflectors].copy(),
        load_point=data.site_xpos[None, at.load_point].copy(),
        wrench=step.wrench[None].copy(),
        counterbalance_force=pull,
        gas_force=gas_force(compiled, pull, length),
        counterbalance_length=length,
    )
