"""Planned measurements: poses with loads, what would be read there, and how much that says about the stiffness."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.identify.current import build_current
from bench.identify.force import build_force
from bench.identify.gls import SeriesModel, whiten
from bench.identify.options import Options
from bench.identify.readings import StaticReadings, Systematic
from bench.identify.statics import SecondOrder, equilibrium, motion
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance

PARALLEL = 1e-9  # sine of the angle to gravity below which a load hangs


@dataclass(frozen=True)
class Load:
    """What pulls on the load point during one visit to a pose.

    Attributes:
        direction: Unit vector in base axes.
        forces: [N], one state each, in this order, after the unloaded state that every visit begins with.
    """

    direction: tuple[float, float, float]
    forces: tuple[float, ...]

    def hangs(self, gravity: Array) -> bool:
        """Return whether the load pulls along gravity, shape (3,), so that its direction need not be measured."""
        down = gravity / np.linalg.norm(gravity)
        along = np.array(self.direction)
        return bool(along @ down > 0 and np.linalg.norm(np.cross(along, down)) < PARALLEL)


@dataclass(frozen=True)
class Visits:
    """Visits to poses; each is one series of states.

    Attributes:
        q: Shape (v, n) [rad], motor angles.
        loads: Length v.
    """

    q: Array
    loads: tuple[Load, ...]

    def take(self, rows: Sequence[int] | NDArray[np.int64]) -> "Visits":
        """Return some of the visits, in the order of `rows`."""
        return Visits(self.q[np.asarray(rows)], tuple(self.loads[row] for row in rows))

    def __add__(self, other: "Visits") -> "Visits":
        return Visits(np.concatenate([self.q, other.q]), self.loads + other.loads)


@dataclass(frozen=True)
class Setup:
    """What is the same at every pose: robot, points, instruments.

    Attributes:
        arm: The arm.
        counterbalance: Its counterbalance, if it has one.
        compliance: Shape (n,) [rad/Nm], the best guess there is; off by a factor of two it costs 3 %.
        load_point: Point of the arm where loads act.
        reference_point: Point of the arm whose position is measured.
        sigma_reflector: [m], standard deviation of one coordinate of one tracker reading; one number for all poses, so
            that the choice does not chase the place where the tracker happens to stand.
        sigma_current_torque: Shape (n,) [Nm], standard deviation of one reading of xi_j I_j.
        sigma_wrench: Shape (6,) [N, Nm], standard deviation of one reading of the load.
        systematic: Prior standard deviations of the instruments' systematic errors.
        n_repeats: Readings of each state.
    """

    arm: Arm
    counterbalance: Counterbalance | None
    compliance: Array
    load_point: str
    reference_point: str
    sigma_reflector: float
    sigma_current_torque: Array
    sigma_wrench: Array
    systematic: Systematic
    n_repeats: int = 10


@dataclass(frozen=True)
class PlannedMethod:
    """What planning has to know of a method of identification.

    Attributes:
        build: Setup and readings -> the linearised problem; its parameters are N and then nuisances.
        nuisance_sigma: Setup -> prior standard deviations of the nuisances.
        gain_covariance: Setup -> covariance of N by gain errors that no choice of poses reveals, shape (n, n).
    """

    build: Callable[[Setup, StaticReadings], SeriesModel]
    nuisance_sigma: Callable[[Setup], Array]
    gain_covariance: Callable[[Setup], Array]


PLANNED = {
    "current": PlannedMethod(
        build=lambda setup, readings: build_current(setup.arm, readings, Options(), setup.compliance),
        nuisance_sigma=lambda setup: np.zeros(0),
        gain_covariance=lambda setup: np.diag((setup.compliance * setup.systematic.torque_gain) ** 2),
    ),
    "force": PlannedMethod(
        build=lambda setup, readings: build_force(
            setup.arm, setup.counterbalance, readings, Options(), setup.compliance
        ),
        nuisance_sigma=lambda setup: np.full(3, setup.systematic.force_direction),
        gain_covariance=lambda setup: setup.systematic.force_gain**2 * np.outer(setup.compliance, setup.compliance),
    ),
}


def planned_readings(setup: Setup, visits: Visits) -> StaticReadings:
    """Return what perfect instruments would read on a robot without friction, with the noise that real ones have."""
    n_states = [1 + len(load.forces) for load in visits.loads]
    series = np.repeat(np.arange(len(n_states)), n_states)
    force = np.concatenate([(0.0, *load.forces) for load in visits.loads])
    direction = np.array([load.direction for load in visits.loads])[series]
    wrench = np.concatenate([force[:, None] * direction, np.zeros_like(direction)], axis=1)
    q, place = visits.q[series], (setup.arm, setup.counterbalance, setup.load_point)
    torque, load = equilibrium(*place, q, wrench, setup.compliance, SecondOrder.ALL)
    moved = motion(setup.arm, setup.reference_point, q, torque, setup.compliance, SecondOrder.ALL, load.stiffness)
    hangs = np.array([load.hangs(setup.arm.bodies.gravity) for load in visits.loads])
    return StaticReadings(
        series=series,
        is_reference=force == 0,
        q_motor=q,
        current_torque=-torque,
        reflectors=moved.position[:, None],
        wrench=wrench,
        is_vertical=hangs[series],
        n_repeats=np.full(len(series), setup.n_repeats),
        sigma_current_torque=setup.sigma_current_torque,
        sigma_reflector=setup.sigma_reflector,
        sigma_wrench=setup.sigma_wrench,
        reflector_names=(setup.reference_point,),
        load_point=setup.load_point,
        systematic=setup.systematic,
    )


def information(setup: Setup, visits: Visits, method: PlannedMethod) -> Array:
    """Return what each visit says about the relative compliances N_j / N_j,guess and the nuisances, shape (v, p, p).

    Visits are independent of each other, so what several say is the sum. Only differences to the unloaded state count:
    each visit has an offset of its own, which takes along tracker frame, gravity at the pose and current offset.
    """
    readings = planned_readings(setup, visits)
    rows = whiten(method.build(setup, readings)).regressor
    rows = rows * np.concatenate([setup.compliance, np.ones(rows.shape[1] - len(setup.compliance))])
    start = 3 * np.searchsorted(readings.series, np.arange(len(visits.loads)))
    summed: Array = np.add.reduceat(rows[:, :, None] * rows[:, None, :], start, axis=0)
    return summed
