"""The next measuring poses for a robot, from its own instruments and rating, compared with those of a scenario."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite

import numpy as np

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.pose_candidates import Rules
from bench.identify.pose_design import PoseDesign, design_poses
from bench.identify.pose_plan import Load, Setup, Visits
from bench.identify.pose_precision import Precision, expected_precision
from bench.identify.readings import Systematic
from bench.report.measuring_poses.request import PoseRequest
from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.figures import Rating
from bench.robot.folder import Robot, load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.files import read_as, said_of
from bench.scenario.loading import Loading

LADDER = np.linspace(1 / 3, 2 / 3, 4)  # forces as shares of the rated one; Table 5 goes from 0.31 to 0.72
LOADS_KNOWN = (
    "No force sensor stands in figures.yaml: loads are taken as known in size and direction, as `bench identify` takes "
    "the weights of a campaign. That holds for weights that hang; what slants needs a sensor."
)
AZIMUTHS = 8  # directions around the vertical in which a slanting load may pull


@dataclass(frozen=True)
class PosePlan:
    """Designed poses and what they are compared with.

    Attributes:
        robot: Name or path of its folder, as it was asked for.
        design: The new poses.
        after: Name of the scenario that was measured before; None without one.
        against: Name of the scenario they are compared with; None without one.
        reference: What its poses tell; None without one.
        reads_loads: The robot has a force sensor; without one the loads are taken as known.
    """

    robot: str
    design: PoseDesign
    after: str | None
    against: str | None
    reference: Precision | None
    reads_loads: bool

    @property
    def notes(self) -> tuple[str, ...]:
        """What the design does not tell or takes for granted, one sentence each."""
        is_known = self.design.method == "force" and not self.reads_loads
        return (*self.design.precision.notes, *((LOADS_KNOWN,) if is_known else ()))

    @property
    def efficiency(self) -> float | None:
        """D-efficiency against the reference; None without one."""
        return None if self.reference is None else self.design.precision.efficiency(self.reference)


def plan_poses(request: PoseRequest, phase: Callable[[str], None] = lambda words: None) -> PosePlan:
    """Design poses for a robot with its own instruments and rating; `phase` is told what begins.

    Raises:
        InputError: The robot has no tracker, or no current sensor for currents, a scenario does not exist or is no
            loading, that of `after` is for another robot, an angle makes no sense, or too few poses can be reached.
    """
    _check(request)
    compiled = compile_robot(load_robot(request.robot))
    rating = compiled.robot.figures.rating
    setup = setup_of(compiled, request.method)
    measured = None if request.after is None else _visits_on(compiled.robot, request.after)
    if request.after is not None and measured is None:
        raise InputError(
            f"scenario {request.after!r} is for another robot than {compiled.robot.name!r}; name one of its own."
        )
    other = None if request.against is None else _visits_on(compiled.robot, request.against)
    rules = Rules(
        worst_wrench=np.repeat([rating.force_n, rating.moment_nm], 3),
        zone_limit=request.zone_limit,
        margin=np.deg2rad(request.margin_deg),
        floor=request.floor_m,
        clearance=request.clearance_m,
        hanging_height=request.hanging_height_m,
        rope_clearance=request.rope_clearance_m,
    )
    design = design_poses(
        setup,
        request.method,
        rules,
        hanging_load(setup, rating),
        slanting_loads(setup, rating, request.slant_deg),
        request.count,
        request.slanting,
        np.random.default_rng(request.seed),
        measured,
        phase,
    )
    reads_loads = compiled.robot.figures.instruments.force is not None
    if other is None:
        return PosePlan(request.robot, design, request.after, None, None, reads_loads)
    reference = expected_precision(setup, other, request.method)
    return PosePlan(request.robot, design, request.after, request.against, reference, reads_loads)


def _check(request: PoseRequest) -> None:
    """Hold numbers of a request against what they can be.

    Raises:
        InputError: One is not, nan among them; all are listed.
    """
    limits = {
        "slanting": (0.0, inf, "a number of poses of 0 or more"),
        "margin_deg": (0.0, 180.0, "an angle of 0 to 180 deg"),
        "floor_m": (-inf, inf, "a finite height"),
        "clearance_m": (0.0, inf, "a finite distance of 0 or more"),
        "hanging_height_m": (-inf, inf, "a finite height"),
        "rope_clearance_m": (0.0, inf, "a finite distance of 0 or more"),
        "zone_limit": (0.0, inf, "a finite relative error of 0 or more"),
    }
    problems = []
    for name, (least, most, what) in limits.items():
        value = getattr(request, name)
        if not (isfinite(value) and least <= value <= most):
            problems.append(f"--{name.replace('_', '-')} {value:g}: must be {what}.")
    if problems:
        raise InputError(problems)


def setup_of(compiled: CompiledRobot, method: str) -> Setup:
    """Return what is the same at every pose: the tracker's noise is that at the distance of the home pose.

    Without a force sensor the loads are known, as `static_readings` has them then.

    Raises:
        InputError: The robot has no tracker, or no current sensor for currents.
    """
    figures = compiled.robot.figures
    tracker, current, force = figures.instruments.tracker, figures.instruments.current, figures.instruments.force
    if tracker is None or (current is None and method == "current"):
        needed = "a tracker" if tracker is None else "a current sensor"
        raise InputError(
            f"{compiled.robot.name}: method {method!r} needs {needed}: figures.yaml has none among its instruments."
        )
    arm = Arm(rigid_bodies(compiled))
    home = np.clip(np.zeros(arm.n_joints), *compiled.limits.T)
    distance = np.linalg.norm(arm.pose(home, figures.reflectors[0])[0] - np.array(tracker.position_m))
    rounding = current.resolution_a / np.sqrt(12) if current else 0.0
    torque_error = np.array([drive.torque_constant_error for drive in figures.drives])
    return Setup(
        arm=arm,
        counterbalance=compiled.counterbalance,
        compliance=1 / compiled.stiffness,
        load_point=figures.load_point,
        reference_point=figures.reflectors[0],
        sigma_reflector=float(tracker.sigma_per_distance * distance),
        sigma_current_torque=compiled.torque_constant * np.hypot(current.sigma_a if current else 0.0, rounding),
        sigma_wrench=np.repeat([force.sigma_n, force.sigma_nm] if force else [0.0, 0.0], 3),
        systematic=Systematic(
            torque_gain=np.hypot(current.gain_sigma if current else 0.0, torque_error),
            force_gain=force.gain_sigma if force else 0.0,
            force_direction=force.direction_sigma_rad if force else 0.0,
        ),
    )


def hanging_load(setup: Setup, rating: Rating) -> Load:
    """Return a ladder of weights."""
    gravity = setup.arm.bodies.gravity
    return Load(_unit(gravity), tuple((LADDER * rating.force_n).tolist()))


def slanting_loads(setup: Setup, rating: Rating, slant_deg: float) -> list[Load]:
    """Return the same ladder, pulling at an angle to the vertical, all around.

    Raises:
        InputError: The angle is not between 0 and 90 deg.
    """
    if not 0 < slant_deg < 90:
        raise InputError(f"the angle of a slanting load is {slant_deg:g} deg; it must be between 0 and 90 deg.")
    down = np.array(_unit(setup.arm.bodies.gravity))
    side = np.cross(down, np.eye(3)[np.argmin(np.abs(down))])
    side /= np.linalg.norm(side)
    slant = np.deg2rad(slant_deg)
    turns = np.arange(AZIMUTHS) * 2 * np.pi / AZIMUTHS
    around = [np.cos(turn) * side + np.sin(turn) * np.cross(down, side) for turn in turns]
    forces = hanging_load(setup, rating).forces
    return [Load(_unit(np.cos(slant) * down + np.sin(slant) * out), forces) for out in around]


def visits_of(scenario: Loading) -> Visits:
    """Return the poses of a loading scenario, each visited once, loading up only, so that designs compare with it."""
    loads = tuple(Load(_unit(np.array(pose.direction)), pose.force_n) for pose in scenario.poses)
    return Visits(np.deg2rad([pose.q_deg for pose in scenario.poses]), loads)


def _visits_on(robot: Robot, name: str) -> Visits | None:
    """Return the visits of a loading scenario, None where it is for another robot."""
    scenario = read_as(Loading, name)
    with said_of(name):
        return visits_of(scenario) if load_robot(scenario.robot).folder == robot.folder else None


def _unit(vector: Array) -> tuple[float, float, float]:
    x, y, z = np.asarray(vector, dtype=np.float64) / np.linalg.norm(vector)
    return float(x), float(y), float(z)
