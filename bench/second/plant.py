"""The second plant: every drive in balance at every instant of a course, its friction remembering the way there.

Motors follow their commands through servos that give. Each link rests where spring, friction, gravity, load, gas and
inertia balance. What drives do to each other is small against their springs (some parts in a thousand), so all of them
are solved along the whole course in turn, a few times over.
"""

from dataclasses import dataclass

import numpy as np

from bench.errors import ConvergenceError
from bench.second.course import Course
from bench.second.figures import Array, Figures, Friction
from bench.second.kinematics import (
    Frames,
    asked_of_joints,
    frames,
    inertia_torque,
    leaned_gravity,
    moment_on_base,
)
from bench.second.path import Element, Spring, link_path, motor_path

ROUNDS = 40
CLOSE = 2e-9  # [rad], between two rounds: a hundredth of an encoder's step, 0.02 Nm on the stiffest drive
HANGING = 5e-3  # share of instants in which a link may hang in its play, where some Nm decide on no flank; assumed
HOUR = 3600.0  # [s]


@dataclass(frozen=True, eq=False)
class State:
    """What is true at T instants; n drives, r reflectors.

    Attributes:
        q, theta: Shape (T, n) [rad], angles of motors and links.
        torque: Shape (T, n) [Nm], of the motors.
        pull: Shape (T,) [N], of the gas alone; nan without a cylinder.
        reflectors: Shape (T, r, 3) [m].
    """

    q: Array
    theta: Array
    torque: Array
    pull: Array
    reflectors: Array


@dataclass(frozen=True, eq=False)
class Chance:
    """Where friction is found when a visit is read first: shares of the level, shape (T, n); nan: it remembers."""

    motor: Array
    link: Array

    @classmethod
    def draw(cls, course: Course, on_motors: float, on_links: float, rng: np.random.Generator) -> "Chance":
        """Draw friction between its levels, for some share of the drives at every arrival, on either side."""
        drawn = []
        for share in (on_motors, on_links):
            values = np.full(course.command.shape, np.nan)
            moved = course.arrives[:, None] & (rng.random(values.shape) < share)
            values[moved] = rng.uniform(-1, 1, int(np.sum(moved)))
            drawn.append(values)
        return cls(*drawn)


def follow(figures: Figures, course: Course, chance: Chance) -> State:
    """Return what is true along a course.

    Args:
        figures: The arm.
        course: What it is asked to do.
        chance: Where friction is found at arrivals.

    Raises:
        ConvergenceError: The rounds do not come to an end.
    """
    # what encoders show late, servos let drives do early
    early = figures.readout.delay
    wanted = course.command - figures.readout.zero + early * course.velocity
    velocity = course.velocity + early * course.acceleration
    acceleration = course.acceleration + early * course.jerk
    inertia, pushes = np.zeros_like(wanted), np.zeros((len(wanted), 3))
    for mass in np.unique(course.payload):
        rows = course.payload == mass
        inertia[rows], pushes[rows] = inertia_torque(
            figures.with_payload(float(mass)), wanted[rows], velocity[rows], acceleration[rows]
        )
    rotors = figures.rotor_inertia * acceleration + figures.viscous * velocity
    fading = np.exp(-figures.servo.decay * course.passed[:, None])
    springs = figures.springs
    q, theta, spring = wanted.copy(), wanted.copy(), np.zeros_like(wanted)
    on_motor, on_link = np.zeros_like(wanted), np.zeros_like(wanted)
    for _ in range(ROUNDS):
        at, lean, asked = _asked(figures, course, theta, pushes)
        asked += inertia
        before = theta.copy()
        motor = _elements(figures.motor, q, velocity, spring, chance.motor)
        link = _elements(figures.link, theta, velocity, spring, chance.link)
        for j in range(figures.n):
            needed, kp = rotors[:, j] + spring[:, j], float(figures.servo.kp[j])
            q[:, j], on_motor[:, j] = motor_path(
                wanted[:, j], needed, motor[j], kp, fading[:, j], course.begins, figures.law
            )
            rubs = [link[j]]
            if figures.gas and figures.gas.joint == j and figures.gas.seal:
                rubs.append(_seal(figures, course, theta[:, j]))
            kind = Spring(*(float(v[j]) for v in (springs.stiffness, springs.softness, springs.knee, springs.gap)))
            theta[:, j], forces = link_path(kind, q[:, j], asked[:, j], rubs, course.begins, figures.law)
            on_link[:, j] = np.sum(forces, axis=1)
        spring = asked - on_link
        unsettled = np.mean(np.max(np.abs(theta - before), axis=1) > CLOSE)
        if unsettled <= (HANGING if np.any(figures.springs.gap) else 0.0):
            break
    else:
        raise ConvergenceError("the second plant finds no balance; is the load far above the rating?")
    gas = figures.gas
    points = np.stack([at.point(spot) for spot in figures.reflectors], axis=1)
    return State(
        q,
        theta,
        rotors + spring - on_motor,
        gas.pull(theta[:, gas.joint], course.time / HOUR) if gas else np.full(len(theta), np.nan),
        points + np.cross(lean[:, None], points),
    )


def _asked(figures: Figures, course: Course, theta: Array, pushes: Array) -> tuple[Frames, Array, Array]:
    """Return frames, lean of the base, shape (T, 3) [rad], and what rest asks of spring and friction, (T, n) [Nm].

    Args:
        figures: The arm.
        course: What it does.
        theta: Shape (T, n) [rad], of the links.
        pushes: Shape (T, 3) [Nm], moments about the foot by which links push it that are accelerated.
    """
    at = frames(figures, theta)
    lean, asked = np.zeros((len(theta), 3)), np.empty_like(theta)
    for mass in np.unique(course.payload):
        rows = course.payload == mass
        arm, here = figures.with_payload(float(mass)), Frames(at.origin[rows], at.axes[rows])
        wrench = (1 + figures.hung_change) * course.wrench[rows]
        if figures.base_compliance:
            moment = moment_on_base(arm, here, wrench) + pushes[rows]
            lean[rows, :2] = figures.base_compliance * moment[:, :2]
        turned = wrench.copy()
        for part in (slice(0, 3), slice(3, 6)):
            turned[:, part] -= np.cross(lean[rows], wrench[:, part])
        asked[rows] = asked_of_joints(arm, here, leaned_gravity(figures, lean[rows]), turned)
    if figures.gas:
        angle = theta[:, figures.gas.joint]
        asked[:, figures.gas.joint] += figures.gas.pull(angle, course.time / HOUR) * figures.gas.lever(angle)
    for joint, torque, middle, width in figures.dents:
        u = (theta[:, joint] - middle) / width
        with np.errstate(under="ignore"):
            asked[:, joint] += torque * u * np.exp((1 - u * u) / 2)
    return at, lean, asked


def _elements(friction: Friction, x: Array, velocity: Array, load: Array, drawn: Array) -> list[Element]:
    """Return the friction elements of one side, one for each drive."""
    plus, minus = friction.levels(x, velocity, load)
    return [
        Element(np.full(len(x), friction.stiffness[j]), plus[:, j], minus[:, j], drawn[:, j]) for j in range(x.shape[1])
    ]


def _seal(figures: Figures, course: Course, theta: Array) -> Element:
    """Return the seals of the cylinder as an element on the joint."""
    gas = figures.gas
    assert gas
    lever = gas.lever(theta)
    level: Array = gas.seal * gas.pull(theta, course.time / HOUR)
    on_joint: Array = level * np.abs(lever)
    return Element(level / gas.seal_travel * lever**2, on_joint, on_joint, np.full(len(theta), np.nan))
