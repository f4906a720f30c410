"""The replay in C against the same search in NumPy, on every kind of model, and in its failures."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.errors import ConvergenceError
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.folder import Robot, load_robot
from bench.simulate import prescribed, reference_replay
from bench.simulate.prescribed import Motion, Prescribed
from bench.simulate.reference_replay import Reference
from bench.simulate.trace import Array, Trace

AGREE = 1e-10  # of angles [rad] and of the largest torque
# [Nm/rad], of the slopes with which a search steps, 1e5 to 1e6: a torque of some kNm is rounded to 1e-12 Nm, a secant
# divides the difference of two by a step that may be as small as the resolution, and two secants are compared
AGREE_SLOPE = 4e-12 / prescribed.STEP_RESOLUTION
LENGTH = 40
ACTING = {
    "loose": ("backlash", {"gap": 4e-4}),
    "soft middle": ("softening", {"softness": 0.6, "knee": 0.1}),
    "hysteresis": ("hysteresis", {"level": 100.0, "slip": 1e-4}),
    "passive hinges": ("bearing_tilt", {"compliance": 2e-7}),
    "base on hinges": ("base_compliance", {"compliance": 1e-7}),
    "warming gas": ("thermal_relaxation", {"gamma_excess": 0.4, "relaxation_time": 20.0}),
    "seals": ("seal_friction", {"share": 0.05}),
    "inertia without mass": ("unstated_payload", {"second_moment_x": 20.0}),
    "friction over speed": ("stribeck", {"rise": 0.4, "speed": 0.05}),
}


def _rigid(spec: mujoco.MjSpec, robot: Robot) -> None:
    for drive in robot.figures.drives:
        spec.tendon(drive.element).stiffness = 1e3 * np.asarray(spec.tendon(drive.element).stiffness)


def _hardening(spec: mujoco.MjSpec, robot: Robot) -> None:
    for drive in robot.figures.drives:
        k = float(np.asarray(spec.tendon(drive.element).stiffness)[0])
        spec.tendon(drive.element).stiffness = [k, 0.0, 1e3 * k]


def _plastic(spec: mujoco.MjSpec, robot: Robot) -> None:
    for drive in robot.figures.drives:
        spec.tendon(drive.element).springyield = 40.0


def _cubic_drag(spec: mujoco.MjSpec, robot: Robot) -> None:
    for joint in spec.joints:
        joint.damping = [30.0, 0.0, 5.0]


def _weak_friction(spec: mujoco.MjSpec, robot: Robot) -> None:
    for drive in robot.figures.drives:
        spec.actuator(drive.link_friction).forcelimited = True
        spec.actuator(drive.link_friction).forcerange = (-10.0, 10.0)


def _limited_joints(most: float) -> SpecEdit:
    """Return an edit by which joints cut off what actuators do on them, as a URDF's `effort` becomes."""

    def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
        for drive in robot.figures.drives:
            spec.joint(drive.joint).actfrclimited = True
            spec.joint(drive.joint).actfrcrange = (-most, most)
            spec.actuator(drive.servo).forcerange = (-most / 2, most / 2)

    return edit


# the last two are for MuJoCo to evaluate
EDITS: dict[str, SpecEdit] = {
    "rigid": _rigid,
    "limited joints": _limited_joints(1e6),
    "joints whose friction is cut off": _limited_joints(20.0),
    "hardening": _hardening,
    "plastic": _plastic,
    "cubic drag": _cubic_drag,
    "weak friction": _weak_friction,
}


def _compiled(kind: str, robot: str = "hh150") -> CompiledRobot:
    folder = load_robot(robot)
    if kind == "nominal":
        return compile_robot(folder)
    if kind in EDITS:
        return compile_robot(folder, [EDITS[kind]])
    name, values = ACTING[kind]
    effect = catalogue()[name]
    nominal = compile_robot(folder)
    place = effect.places(nominal)[-1]
    edit = effect.edit(place, effect.complete(values), Conditions.reference(folder.n_joints))
    assert edit
    return compile_robot(folder, [edit])


def _motion(n: int, rng: np.random.Generator) -> Motion:
    """Return a walk there and back with a rest in the middle, under a load that comes and goes."""
    phase = np.linspace(0, 2 * np.pi, LENGTH)
    moves = (phase < 0.8 * np.pi) | (phase > 1.2 * np.pi)
    amplitude = rng.uniform(0.05, 0.4, n)
    wrench = np.zeros((LENGTH, 6))
    wrench[LENGTH // 3 : 2 * LENGTH // 3] = rng.normal(0, 200, 6)
    return Motion(
        time=100.0 + np.linspace(0, 30, LENGTH),
        q=amplitude * np.sin(phase)[:, None],
        velocity=amplitude * np.cos(phase)[:, None] * moves[:, None],
        acceleration=-amplitude * np.sin(phase)[:, None] * moves[:, None],
        wrench=wrench,
        read=np.arange(LENGTH) % 7 != 0,
    )


@pytest.mark.parametrize("kind", ["nominal", *EDITS, *ACTING])
@pytest.mark.parametrize("guessed", [False, True])
def test_c_and_numpy_agree(kind: str, guessed: bool, rng: np.random.Generator) -> None:
    compiled = _compiled(kind)
    _agree(compiled, _motion(compiled.n_joints, rng), guessed)


def test_c_and_numpy_agree_on_gas_that_is_warm_at_first(rng: np.random.Generator) -> None:
    compiled = _compiled("warming gas")
    motion = _motion(compiled.n_joints, rng)
    warm = replace(motion, gas_rise=np.full(LENGTH, 0.03))
    _agree(compiled, warm, False)
    cool, told = (Prescribed(compiled).follow(one) for one in (motion, warm))
    assert compiled.counterbalance
    theta, dt = told[1][:, 0, compiled.counterbalance.joint], np.diff(motion.time)
    rises = [compiled.counterbalance.temperature_rise(theta, dt, first)[motion.read] for first in (0.0, 0.03)]
    np.testing.assert_allclose(told[0].gas_force / cool[0].gas_force, (1 + rises[1]) / (1 + rises[0]), rtol=1e-4)


@pytest.mark.parametrize("robot", ["emps", "kr300"])
def test_c_and_numpy_agree_on_other_robots(robot: str, rng: np.random.Generator) -> None:
    compiled = _compiled("nominal", robot)
    motion = _motion(compiled.n_joints, rng)
    _agree(compiled, replace(motion, q=0.1 * motion.q), False)


def _agree(compiled: CompiledRobot, motion: Motion, guessed: bool) -> None:
    guess = None
    if guessed:  # as the nominal robot found it, from which the search starts in a diagnosis
        slack = 1 + 1e-3 * np.arange(Prescribed(compiled).n_unknowns)
        guess = Reference(compiled).follow(motion)[1] * slack
    wound_up = 0.9 * motion.velocity, 0.8 * motion.acceleration
    for links in (None, wound_up):
        by_numpy = Reference(compiled).follow(motion, guess, links)
        _agree_on(by_numpy, Prescribed(compiled).follow(motion, guess, links))


def _agree_on(by_numpy: tuple[Trace, Array, Array], in_c: tuple[Trace, Array, Array]) -> None:
    (expected, found, load), (trace, places, loads) = by_numpy, in_c
    np.testing.assert_allclose(loads, load, rtol=0, atol=AGREE * np.max(np.abs(load)))
    np.testing.assert_allclose(places[:, 0], found[:, 0], rtol=0, atol=AGREE)
    np.testing.assert_allclose(places[:, 1], found[:, 1], rtol=0, atol=AGREE_SLOPE)
    for name in vars(expected):
        one, other = getattr(trace, name), getattr(expected, name)
        np.testing.assert_allclose(one, other, rtol=AGREE, atol=AGREE * np.nanmax(np.abs(other), initial=1.0))


def test_motions_joined_are_motions_one_by_one(rng: np.random.Generator) -> None:
    compiled = _compiled("seals")
    motions = [_motion(compiled.n_joints, rng) for _ in range(3)]
    robot = Prescribed(compiled)
    alone = [robot.follow(motion)[1] for motion in motions]
    together = robot.follow(Motion.concatenate(motions))[1]
    np.testing.assert_array_equal(together, np.concatenate(alone))


def _second(motion: Motion) -> Motion:
    """Return the second half of a motion alone."""
    kept = slice(LENGTH // 2, None)
    names = ("time", "q", "velocity", "acceleration", "wrench", "read")
    return Motion(**{name: getattr(motion, name)[kept] for name in names})


def test_gas_is_as_warm_as_told_where_a_motion_begins(rng: np.random.Generator) -> None:
    """Friction is told again by the approach of a motion; heat that was compressed into the gas is not."""
    compiled = _compiled("warming gas")
    robot, motion = Prescribed(compiled), _motion(compiled.n_joints, rng)
    half = np.arange(LENGTH) >= LENGTH // 2
    begins = np.isin(np.arange(LENGTH), [0, LENGTH // 2])
    whole, found, _ = robot.follow(motion)
    rise = compiled.counterbalance.temperature_rise(found[:, 0, 1], np.diff(motion.time))
    cold, told = (robot.follow(replace(motion, begins=begins, gas_rise=given))[0].gas_force for given in (None, rise))
    alone = robot.follow(_second(motion))[0].gas_force
    read = half[motion.read]
    remembered = np.max(np.abs(cold - whole.gas_force)[read])
    assert remembered > 10.0  # [N]
    assert np.max(np.abs(told - whole.gas_force)) < 0.05 * remembered
    np.testing.assert_allclose(cold[read], alone, atol=0.05 * remembered)


@pytest.mark.parametrize("kind", ["nominal", "loose", "passive hinges"])
@pytest.mark.parametrize("iterations", [1, 2, 8])
def test_failures_are_the_same(
    kind: str, iterations: int, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled = _compiled(kind)
    motion = _motion(compiled.n_joints, rng)
    for module in (prescribed, reference_replay):
        monkeypatch.setattr(module, "MAX_ITERATIONS", iterations)
    told = _told(Prescribed(compiled).follow, motion)
    assert told == _told(Reference(compiled).follow, motion)
    assert iterations > 1 or told.startswith("no balance at 100.000 s within 1 iterations")


def _told(follow: Callable[[Motion], object], motion: Motion) -> str:
    try:
        follow(motion)
    except ConvergenceError as error:
        return str(error)
    return "balances everywhere"


def test_threads_share_a_model(rng: np.random.Generator) -> None:
    """Each with its own data; the length of a step is that of its own motion."""
    compiled = _compiled("warming gas")
    motions = [_motion(compiled.n_joints, rng) for _ in range(8)]
    alone = [Prescribed(compiled).follow(motion)[1] for motion in motions]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda motion: Prescribed(compiled).follow(motion)[1], motions))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one, other)
