"""The next measuring poses for a robot: designed, compared with those of a scenario, as table, JSON and scenario file."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.pose_candidates import Rules
from bench.identify.pose_design import PoseDesign, design_poses
from bench.identify.pose_plan import Load, Setup, Visits
from bench.identify.pose_precision import Precision, expected_precision
from bench.identify.readings import Systematic
from bench.record.yaml_text import dump_yaml
from bench.report.files import replacing
from bench.report.identification import plain
from bench.report.tables import Column, Measured, Row, print_table
from bench.robot.compiled import CompiledRobot, compile_robot, rigid_bodies
from bench.robot.figures import Rating
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from bench.scenario.loading import Loading

LADDER = np.linspace(1 / 3, 2 / 3, 4)  # forces as shares of the rated one; Table 5 goes from 0.31 to 0.72
AZIMUTHS = 8  # directions around the vertical in which a slanting load may pull
DIGITS = 4  # of a direction written to a scenario


@dataclass(frozen=True)
class PosePlan:
    """Designed poses and what they are compared with.

    Attributes:
        robot: Name of the robot.
        design: The new poses.
        against: Name of the scenario they are compared with; None without one.
        reference: What its poses tell; None without one.
    """

    robot: str
    design: PoseDesign
    against: str | None
    reference: Precision | None

    @property
    def efficiency(self) -> float | None:
        """D-efficiency against the reference; None without one."""
        return None if self.reference is None else self.design.precision.efficiency(self.reference)


def plan_poses(
    robot: str,
    count: int,
    method: str,
    slanting: int,
    slant_deg: float,
    against: str | None,
    after: str | None,
    seed: int,
) -> PosePlan:
    """Design poses for a robot with its own instruments and rating.

    Args:
        robot: Name of a robot folder, or a path to one.
        count: Number of poses.
        method: "current" or "force".
        slanting: Number of poses at which the load may slant.
        slant_deg: Angle between a slanting load and the vertical [deg].
        against: Loading scenario to compare with; left out where it is of another robot.
        after: Loading scenario whose poses have been measured already.
        seed: Of the candidates.

    Raises:
        InputError: The robot has no tracker or lacks the method's instrument, `after` is of another robot, or too few
            poses can be reached.
    """
    compiled = compile_robot(load_robot(robot))
    setup, rating = setup_of(compiled, method), compiled.robot.figures.rating
    measured = None if after is None else read_scenario(after)
    if measured is not None and measured.robot != compiled.robot.name:
        raise InputError(f"scenario {after!r} is for robot {measured.robot!r}, not {compiled.robot.name!r}.")
    design = design_poses(
        setup,
        method,
        Rules(worst_wrench=np.repeat([rating.force_n, rating.moment_nm], 3)),
        hanging_load(setup, rating),
        slanting_loads(setup, rating, slant_deg),
        count,
        slanting,
        np.random.default_rng(seed),
        None if measured is None else visits_of(measured),
    )
    other = None if against is None else read_scenario(against)
    if other is None or other.robot != compiled.robot.name:
        return PosePlan(compiled.robot.name, design, None, None)
    return PosePlan(compiled.robot.name, design, against, expected_precision(setup, visits_of(other), method))


def setup_of(compiled: CompiledRobot, method: str) -> Setup:
    """Return what is the same at every pose: the tracker's noise is that at the distance of the home pose.

    Raises:
        InputError: The robot has no tracker or lacks the method's instrument.
    """
    figures = compiled.robot.figures
    tracker, current, force = figures.instruments.tracker, figures.instruments.current, figures.instruments.force
    if tracker is None or (current is None if method == "current" else force is None):
        raise InputError(
            f"{compiled.robot.name}: method {method!r} needs a tracker and a {method} sensor; figures.yaml."
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


def scenario_of(plan: PosePlan) -> Loading:
    """Return the designed poses as a loading scenario that `bench run` takes."""
    visits = plan.design.visits
    poses = [
        {
            "q_deg": np.round(q, DIGITS).tolist(),
            "force_n": np.round(load.forces).tolist(),
            "direction": np.round(load.direction, DIGITS).tolist(),
        }
        for q, load in zip(plan.design.q_deg, visits.loads, strict=True)
    ]
    notes = f"D-optimal for the {plan.design.method} method (bench poses)"
    return Loading.model_validate({"experiment": "loading", "robot": plan.robot, "notes": notes, "poses": poses})


def write_scenario(plan: PosePlan, file: Path) -> None:
    """Write the designed poses as a scenario file.

    Raises:
        InputError: The folder does not exist or cannot be written to.
    """
    with replacing(file) as partial:
        content = scenario_of(plan).model_dump(mode="json", exclude_defaults=True)
        partial.write_text(dump_yaml({"experiment": "loading"} | content), encoding="utf-8")


def print_plan(plan: PosePlan) -> None:
    """Print poses and loads, then what to expect of them and of the reference."""
    design, names = plan.design, plan.design.precision.joint_names
    columns = [*(Column(name, "deg", 0) for name in names), *(Column(f"largest f{axis}", "N", 0) for axis in "xyz")]
    rows = [
        Row(str(i + 1), tuple(Measured(value) for value in (*q, *(max(load.forces) * np.array(load.direction) + 0.0))))
        for i, (q, load) in enumerate(zip(design.q_deg, design.visits.loads, strict=True))
    ]
    steps = ", ".join(f"{force:.0f}" for force in design.visits.loads[0].forces)
    print_table(f"poses for the {design.method} method", columns, rows, [f"Read unloaded, then at {steps} N."])
    expected = [("these poses", design.precision)]
    if plan.reference is not None:
        expected.append((f"scenario {plan.against}", plan.reference))
    rows = [
        Row(name, tuple(Measured(100 * value) for value in precision.standard_error / precision.stiffness))
        for name, precision in expected
    ]
    print_table(
        "expected standard error of k, from instrument noise",
        [Column(name, "%", 2) for name in names],
        rows,
        _words(plan),
    )


def _words(plan: PosePlan) -> list[str]:
    precision = plan.design.precision
    words = [f"Condition number {precision.condition_number:.1f}."]
    if plan.reference is not None:
        words = [
            f"Condition number {precision.condition_number:.1f}, of {plan.against} {plan.reference.condition_number:.1f}. "
            f"D-efficiency against {plan.against}: {plan.efficiency:.2f}."
        ]
    gain = 100 * np.sqrt(np.diag(precision.gain)).max()
    return [*words, f"Gain errors of the instruments add up to {gain:.1f} %, whatever the poses.", *precision.notes]


def print_json(plan: PosePlan) -> None:
    """Print the plan as JSON, units in the keys; what is undefined is null."""
    scenario, precision = scenario_of(plan), plan.design.precision
    content = {
        "robot": plan.robot,
        "method": plan.design.method,
        "poses": [pose.model_dump(mode="json") for pose in scenario.poses],
        "joints": list(precision.joint_names),
        "expected": _as_json(precision),
        "against": plan.against,
        "expected_against": None if plan.reference is None else _as_json(plan.reference),
        "d_efficiency": None if plan.efficiency is None else plain(plan.efficiency),
        "notes": list(precision.notes),
    }
    print(json.dumps(content, indent=2))


def _as_json(precision: Precision) -> dict[str, object]:
    return {
        "stiffness_nm_per_rad": plain(precision.stiffness),
        "standard_error_nm_per_rad": plain(precision.standard_error),
        "standard_error_with_gain_nm_per_rad": plain(precision.total_standard_error),
        "condition_number": plain(precision.condition_number),
    }


def _unit(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = np.asarray(vector, dtype=np.float64) / np.linalg.norm(vector)
    return float(x), float(y), float(z)
