"""Which pose and load to add, for joints that the readings do not tell or tell badly."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.estimate import StiffnessEstimate
from bench.identify.load_axis import on_axis_sentence, turned_by_load
from bench.identify.options import Options
from bench.identify.pose_candidates import Rules, sample
from bench.identify.pose_plan import PLANNED, Load, Setup, Visits, information
from bench.identify.pose_precision import prior_information
from bench.identify.readings import StaticReadings
from bench.robot.bodies import Array
from bench.robot.counterbalance import Counterbalance

Method = Callable[[Arm, Counterbalance | None, StaticReadings, Options], StiffnessEstimate]

WEAK = 0.10  # relative standard error of a compliance above which a better pose is named
N_POSES = 100  # sampled for each kind of load
WORTH_A_ROPE = 1.5  # a slanting load must be better than a hanging one by this factor: its direction has to be measured
AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Advice:
    """A pose and a load that would tell one joint best.

    Attributes:
        joint: Index of the joint.
        q: Shape (n,) [rad] or [m], motor positions.
        load: The load to apply there.
        hangs: Whether it may simply hang.
        relative_error: Standard error of the compliance with this visit added, relative to the compliance; of a joint
            of which nothing is known yet, relative to the median compliance of the others.
    """

    joint: int
    q: Array
    load: Load
    hangs: bool
    relative_error: float


def advise(
    arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, estimate: StiffnessEstimate
) -> tuple[Advice, ...]:
    """Return one piece of advice for every joint that is not observable or known to worse than `WEAK`.

    Of a joint on whose axis the load point lies there is none: no pose tells it.

    Poses are sampled inside the joint limits, no lower and no nearer to the base than was measured already, with the
    largest load that was used, hanging or pulling along x or y. What each would add is its information, Eq. (42), on
    top of the estimate's. The same readings give the same advice.

    Raises:
        InputError: Hardly any sampled pose keeps these rules, or nothing at all is known about the stiffness.
    """
    known = np.where(estimate.observable, estimate.compliance, np.nan)
    if not estimate.observable.any():
        raise InputError("no joint is observable from these readings, so that no pose can be judged.")
    guess = np.where(estimate.observable, known, np.nanmedian(known))
    error = np.sqrt(np.diag(estimate.covariance)) / guess
    wanted = np.flatnonzero(~(error <= WEAK) & turned_by_load(arm, readings.load_point))
    if len(wanted) == 0:
        return ()
    method = PLANNED["current" if estimate.method == "current" else "force"]
    setup = _setup(arm, counterbalance, readings, guess)
    visits = _candidates(setup, readings)
    before = prior_information(setup, method)
    seen = np.flatnonzero(estimate.observable)
    block = np.ix_(seen, seen)
    before[block] += np.linalg.inv(estimate.covariance[block] / np.outer(guess, guess)[block])
    after = np.linalg.inv(before + information(setup, visits, method))
    gain = np.diag(method.gain_covariance(setup)) / guess**2
    hangs = np.array([load.hangs(arm.bodies.gravity) for load in visits.loads])
    found = []
    for joint in wanted:
        sigma = np.sqrt(after[:, joint, joint] + gain[joint])
        best = int(np.argmin(np.where(hangs, sigma, WORTH_A_ROPE * sigma)))
        found.append(Advice(int(joint), visits.q[best], visits.loads[best], bool(hangs[best]), float(sigma[best])))
    return tuple(found)


def sentence(advice: Advice, estimate: StiffnessEstimate) -> str:
    """Return the advice in words."""
    name = estimate.joint_names[advice.joint]
    pose = ", ".join(f"{angle:.0f}" for angle in np.rad2deg(advice.q))
    axis = int(np.argmax(np.abs(advice.load.direction)))
    sign = "+" if advice.load.direction[axis] > 0 else "-"
    how = "hanging" if advice.hangs else f"pulling horizontally along {sign}{AXES[axis]}"
    add = f"a pose near ({pose}) deg with {advice.load.forces[0]:.0f} N {how}"
    if not estimate.observable[advice.joint]:
        return f"To see {name}, add {add}; it tells it to {advice.relative_error:.1%} if it is as stiff as the others."
    now = np.sqrt(estimate.covariance[advice.joint, advice.joint]) / estimate.compliance[advice.joint]
    return f"{name} is known to {now:.0%} only; {add} would make that {advice.relative_error:.1%}."


def with_advice(method: Method) -> Method:
    """Return a method whose estimate also says, in its notes, which pose would tell what these readings do not."""

    def advised(
        arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, options: Options
    ) -> StiffnessEstimate:
        estimate = method(arm, counterbalance, readings, options)
        names = zip(estimate.joint_names, turned_by_load(arm, readings.load_point), strict=True)
        on_axis = [on_axis_sentence(name) for name, turned in names if not turned]
        estimate = replace(estimate, notes=(*estimate.notes, *on_axis))
        try:
            found = advise(arm, counterbalance, readings, estimate)
        except InputError as error:
            return replace(estimate, notes=(*estimate.notes, f"No pose to add was found: {error}"))
        return replace(estimate, notes=(*estimate.notes, *(sentence(advice, estimate) for advice in found)))

    return advised


def _setup(arm: Arm, counterbalance: Counterbalance | None, readings: StaticReadings, compliance: Array) -> Setup:
    return Setup(
        arm=arm,
        counterbalance=counterbalance,
        compliance=compliance,
        load_point=readings.load_point,
        reference_point=readings.reflector_names[0],
        sigma_reflector=readings.sigma_reflector,
        sigma_current_torque=readings.sigma_current_torque,
        sigma_wrench=readings.sigma_wrench,
        systematic=readings.systematic,
        n_repeats=int(readings.n_repeats.min()),
    )


def _candidates(setup: Setup, readings: StaticReadings) -> Visits:
    arm, standard = setup.arm, Rules(worst_wrench=np.zeros(6))
    force = float(np.nanmax(np.linalg.norm(readings.wrench[:, :3], axis=1)))
    places = arm.pose(readings.q_motor, setup.load_point)[0]
    lowest, nearest = float(places[:, 2].min()), float(np.linalg.norm(places[:, :2], axis=1).min())
    rules = replace(
        standard,
        worst_wrench=np.concatenate([np.full(3, force), np.zeros(3)]),
        floor=min(standard.floor, lowest),
        hanging_height=min(standard.hanging_height, lowest),
        clearance=min(standard.clearance, nearest),
    )
    down = tuple(arm.bodies.gravity / np.linalg.norm(arm.bodies.gravity))
    across = ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
    rng = np.random.default_rng(0)  # part of the rule: the same readings give the same advice
    hanging = sample(setup, [Load(down, (force,))], rules, N_POSES, rng)
    return hanging + sample(setup, [Load(way, (force,)) for way in across], rules, N_POSES, rng)
