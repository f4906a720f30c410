"""Rotations of which the gas figures are hidden, and the same motion read again by other instruments."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from bench.identify.balancing_torque import BalancingTorque, Geometry, Priors, balancing_torques, nuisances
from bench.identify.counterbalance_fit import CounterbalanceFit, fit_counterbalance
from bench.identify.traverses import traverses
from bench.record.campaign import Campaign
from bench.robot.bodies import RigidBodies
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.drives import Drives, drives_of
from bench.robot.folder import Robot, load_robot
from bench.robot.links import rigid_bodies
from bench.robot.plugins import configure
from bench.scenario.rotation import Rotation
from bench.simulate import session as sessions
from bench.simulate.instruments import Instruments
from bench.simulate.policy import Sitting
from bench.simulate.rotation import rotation_sittings
from bench.simulate.session import Session


def gas(constant: float, critical_length: float) -> SpecEdit:
    """Return the edit that fills other gas into the counterbalance."""

    def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
        assert robot.figures.counterbalance
        actuator = robot.figures.counterbalance.actuator
        configure(spec, actuator, constant=constant, critical_length=critical_length)

    return edit


def run_with(scenario: Rotation, edit: SpecEdit) -> Session:
    """Run a scenario on a robot that differs from its folder."""

    def edited(scenario: Rotation, robot: Robot) -> tuple[Sitting, ...]:
        return tuple(replace(s, edits=(*s.edits, edit)) for s in rotation_sittings(scenario, robot))

    original = sessions.SITTINGS["rotation"]
    sessions.SITTINGS["rotation"] = edited
    try:
        return sessions.run_session(scenario)
    finally:
        sessions.SITTINGS["rotation"] = original


@dataclass(frozen=True)
class Nominal:
    """What identification is given of a robot: as its folder has it, without the gas."""

    compiled: CompiledRobot
    bodies: RigidBodies
    drives: Drives
    geometry: Geometry

    @classmethod
    def of(cls, robot: str) -> "Nominal":
        compiled = compile_robot(load_robot(robot))
        assert compiled.counterbalance
        return cls(compiled, rigid_bodies(compiled), drives_of(compiled), Geometry.of(compiled.counterbalance))

    def torques(self, campaign: Campaign, drives: Drives | None = None) -> tuple[BalancingTorque, ...]:
        drives = drives or self.drives
        found = traverses(campaign, drives, self.bodies.gravity)
        point = self.compiled.robot.figures.load_point
        return balancing_torques(found, self.bodies, drives, self.geometry, point, Priors())

    def fit(self, campaign: Campaign, drives: Drives | None = None) -> CounterbalanceFit:
        limits = self.bodies.limits[self.geometry.joint]
        return fit_counterbalance(self.torques(campaign, drives), self.geometry, nuisances(self.bodies), limits)

    def fit_of_seed(self, session: Session, seed: int) -> CounterbalanceFit:
        """Fit what instruments of another seed read; the stiffness comes from another experiment with its own error."""
        rng = np.random.default_rng(seed)
        campaign = read_again(session, rng)
        error = Priors().compliance * rng.standard_normal(self.bodies.n_joints)
        return self.fit(campaign, replace(self.drives, stiffness=self.drives.stiffness * (1 + error)))


def read_again(session: Session, rng: np.random.Generator) -> Campaign:
    """Return the campaign that instruments with other errors and other noise would have made of the same physics."""
    reading = Instruments(session.compiled, rng).read(session.instants)
    names = np.array([mark.run for mark in session.marks])
    runs = []
    for run in session.campaign.runs:
        rows = names == run.name
        columns = dict(run.columns)
        for j in range(reading.current.shape[1]):
            columns[f"q_motor_{j + 1}_rad"] = reading.q_motor[rows, j]
            columns[f"current_{j + 1}_a"] = reading.current[rows, j]
        runs.append(replace(run, columns=columns))
    return replace(session.campaign, runs=tuple(runs))
