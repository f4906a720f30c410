"""Motions as they are cut into bins: what is read, how exactly accelerations are known, and how long an arm rings."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from bench.diagnose.replay.motion_segments import lowest_period, stretches_of
from bench.diagnose.replay.segment_input import SegmentInput
from bench.diagnose.replay.uneven_derivative import derivative_over
from bench.record.campaign import Array, Run
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.mass_matrix import link_mass_matrix
from tests.diagnose.assumed.registry import needs
from tests.diagnose.sweeps import SWEEP, made, nominal

SAMPLE, SPEED, START = 0.004, 0.1, -0.3  # [s], [rad/s], [rad]
JOINT = 1
TIME = np.arange(0, 12.0, SAMPLE)
CHANGE = 6.0  # [s]


@lru_cache
def setting() -> tuple[CompiledRobot, Run]:
    """Return the nominal robot, and a run to put other angles into."""
    return nominal(), next(run for run in made(SWEEP, seed=3).runs if run.kind == "motion")


def moved(angle: Array, width: float = 0.1) -> SegmentInput:
    """Return the bins of a motion of joint 2, shape (rows,) [rad]; width [s]."""
    compiled, run = setting()
    columns = {"time_s": TIME} | {f"q_motor_{i + 1}_rad": np.zeros(len(TIME)) for i in range(compiled.n_joints)}
    columns[f"q_motor_{JOINT + 1}_rad"] = angle
    (found,) = stretches_of(replace(run, columns=columns), compiled, width)
    return found


def at_speed(speed: Array) -> SegmentInput:
    """Return the bins of a motion of joint 2 at a speed, shape (rows,) [rad/s]."""
    return moved(START + np.cumsum(speed) * SAMPLE)


def beginnings(found: SegmentInput) -> Array:
    """Return when bins begin, shape (T,) [s]."""
    return np.array([TIME[rows[0]] for rows in found.groups])


@needs("record.moving.TRAVELS")
def a_motor_that_gives_does_not_move_and_half_a_degree_is_a_motion() -> None:
    swing = np.sin(2 * np.pi * TIME / 4)
    gives, goes = moved(0.0015 * swing), moved(0.004 * swing)  # over 3 and 8 mrad
    assert not np.any(gives.motion.velocity)
    assert np.any(goes.motion.velocity[:, JOINT])


@needs("record.moving.TURNING")
def what_creeps_is_not_read_and_what_goes_slowly_is() -> None:
    # Between its levels friction may be anywhere: at a fourteenth of the top speed, but not at a tenth.

    def read(share: float) -> int:
        slow = (TIME > 5) & (TIME < 7)
        begins = beginnings(at_speed(np.where(slow, share * SPEED, SPEED)))
        return int(np.count_nonzero((begins > 5.3) & (begins < 6.7)))

    assert read(0.07) == 0
    assert read(0.1) > 5


@needs("replay.motion_segments.STIFF_WINDOW")
def accelerations_of_a_stiff_arm_follow_five_oscillations_a_second_and_are_known_beside_noise() -> None:
    drive = compile_robot(load_robot("emps"))  # its lowest mode is at 200 Hz
    columns = {"time_s": TIME, "q_motor_1_m": SPEED * TIME}
    (found,) = stretches_of(Run("a", "motion", 0.0, columns), drive, 0.2)
    path = found.path
    assert path
    kernel = path.kernel
    follows = abs(np.sum(kernel * np.exp(2j * np.pi * 5.0 * SAMPLE * np.arange(len(kernel)))))
    assert follows > 0.9
    noise = 1e-6 * np.random.default_rng(1).standard_normal((len(TIME), 1))  # [rad], of an encoder
    assert np.std(derivative_over(noise, TIME, len(kernel), 2)) < 0.006  # [rad/s^2]; 0.3 Nm on 50 kg m^2


@needs("replay.motion_segments.UNRESOLVED")
def errors_of_accelerations_are_those_that_they_have() -> None:
    # Of an oscillation of which the error is known: it is covered, by no more than twice.
    period, size = 0.8, 0.002  # [s], [rad]
    turned = 2 * np.pi * TIME / period
    found = moved(START + 0.3 * TIME + size * np.sin(turned))
    assert found.path
    window = len(found.path.kernel) + 2  # second differences of which the kernel makes an average
    own = derivative_over((size * np.sin(turned))[:, None], TIME, window, 2)[:, 0]
    error = np.max(np.abs(own + size * (2 * np.pi / period) ** 2 * np.sin(turned))[200:-200])
    assert 1.0 < np.median(found.acceleration_error[:, JOINT]) / error < 2.0


@needs("replay.motion_segments.JERKY")
def a_step_of_speed_shakes_the_arm() -> None:
    # One of a hundredth does, a little less does not.

    def shakes(step: float) -> bool:
        found = at_speed(np.where(TIME < CHANGE, SPEED, (1 - step) * SPEED))
        begins = beginnings(found)
        return bool(np.any(found.rings[(begins > CHANGE + 0.1) & (begins < CHANGE + 0.4)]))

    assert shakes(0.0115)
    assert not shakes(0.009)


def left_when_settled() -> float:
    """Return what is left of an oscillation of the lowest mode, as the model damps it, when an arm rings no more."""
    compiled, _ = setting()
    found = at_speed(np.full(len(TIME), SPEED))
    q = np.zeros(compiled.n_joints)
    q[JOINT] = START + SPEED * TIME.mean()
    periods = float(beginnings(found)[np.argmin(found.rings)]) / lowest_period(compiled, q)
    return float(np.exp(-2 * np.pi * damping_ratio(compiled, q) * periods))


def damping_ratio(compiled: CompiledRobot, q: Array) -> float:
    """Return the damping ratio of the lowest mode, with the motors held: the elastic elements' own."""
    inertia = link_mass_matrix(compiled, q)
    squares, modes = np.linalg.eig(np.linalg.solve(inertia, np.diag(compiled.stiffness)))
    lowest = int(np.argmin(squares.real))
    mode = modes[:, lowest].real
    damping = mode @ (compiled.model.tendon_damping[compiled.at.element] * mode) / (mode @ inertia @ mode)
    return float(damping / (2 * np.sqrt(squares[lowest].real)))


@needs("replay.motion_segments.DAMPING_RATIO")
def an_arm_rings_as_long_as_its_own_damping_says() -> None:
    assert 0.12 < left_when_settled() < 0.36


@needs("replay.motion_segments.FADED")
def readings_wait_until_bins_show_less_than_a_fifth_of_a_jerk_and_no_longer() -> None:
    through = 2 / np.pi  # of an oscillation, in bins of half its period
    assert 0.12 < through * left_when_settled() < 0.2
