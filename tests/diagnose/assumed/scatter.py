"""Friction at rest and links in gears with play: how many standard deviations what they do is."""

from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from bench.diagnose.linearise.noise_covariance import Scatter, whitening_of
from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.quantities import Quantity
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Array
from bench.robot.folder import load_robot
from tests.diagnose.assumed.registry import needs
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import LOADS, nominal

LOADED = 1  # index of the joint with most friction, and under load in all poses
SEEDS = 3
STIFFNESS, LEVEL, PERIOD = 1e6, 100.0, 0.2  # [Nm/rad], [Nm], [s]
CURRENT, REFLECTOR = Quantity("current_1_a", "current", "A"), Quantity("reflector_1_x_m", "reflector", "m")
FINE = 1e-6  # noise of the instrument, of a level or of a gap
INSTANTS = 60


def surprise(deviation: Array, quantity: Quantity, *, rests: bool, gap: float = 0.0) -> float:
    """Return how many standard deviations a deviation is, of a standing joint: its friction or, with a gap, its link.

    Args:
        deviation: Shape (T,), in Coulomb levels, or in gaps.
        quantity: That shows it.
        rests: Whether these are rests; else motion.
        gap: [rad], of its gear; then it has no friction.
    """
    length = len(deviation)
    unit = np.ones((length, 1, 1))
    zeros, time = np.zeros((length, 1)), 0.1 * np.arange(length)
    inertia = STIFFNESS * (PERIOD / (2 * np.pi)) ** 2
    own = unit / LEVEL if not gap else unit / (STIFFNESS * gap)  # readings in levels, or in gaps
    link, motor = (0 * unit, own) if quantity.is_drive else (own, 0 * unit)
    response = TorqueResponse(link, motor, zeros + inertia, np.ones(1), zeros, zeros)
    segment: Any = SimpleNamespace(
        is_static=rests,
        observed=zeros,
        sigma=zeros + (FINE if not gap or rests else 0.01),
        standing=np.array([True]),
        acceleration_error=zeros,
        drive_error=None,
        motion=SimpleNamespace(time=time, read=np.ones(length, dtype=bool)),
    )
    compiled: Any = SimpleNamespace(
        n_joints=1,
        stiffness=np.array([STIFFNESS]),
        damping=np.zeros(1),
        link_coulomb=np.array([LEVEL]),
        motor_coulomb=np.array([LEVEL]),
    )
    scatter = Scatter(np.array([gap]), np.full((2, 1), 0.0 if gap else LEVEL), 0.0)
    whitening = whitening_of(compiled, segment, response, (quantity,), scatter)
    return float(np.linalg.norm(whitening(deviation[:, None])))


@lru_cache
def simulated() -> tuple[float, float]:
    """Return how far rests of one visit differ in campaigns of the robot in time, in Coulomb levels: motor and link."""
    compiled = nominal()
    found: tuple[list[Array], list[Array]] = ([], [])
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        campaign = hide_campaign(load_robot("hh150"), LOADS, [], rng, background=False).campaign
        linear = linear_of(campaign)
        reflectors = [c for c, quantity in enumerate(linear.quantities) if quantity.kind == "reflector"]
        for response, left in zip(linear.responses, linear.split(linear.residual), strict=True):
            motor = left[:, LOADED] / np.abs(response.motor[:, LOADED, LOADED]) / compiled.motor_coulomb[LOADED]
            link = left[:, reflectors] / np.linalg.norm(response.link[:, reflectors] * compiled.link_coulomb, axis=2)
            for one, values in zip(found, (motor[:, None], link), strict=True):
                one.append(values.std(axis=0, ddof=1))
    motor_rms, link_rms = (float(np.sqrt(np.mean(np.concatenate(one) ** 2))) for one in found)
    return motor_rms, link_rms


def differ(size: float) -> Array:
    """Return two rests of a visit that differ so that their standard deviation is `size`."""
    return np.array([1.0, -1.0]) * size / np.sqrt(2)


@needs("linearise.noise_covariance.MOTOR_REST")
def friction_of_a_motor_scatters_from_rest_to_rest_as_it_does_in_time() -> None:
    assert 0.65 < surprise(differ(simulated()[0]), CURRENT, rests=True) < 1.5


@needs("linearise.noise_covariance.LINK_REST")
def friction_of_a_link_scatters_from_rest_to_rest_as_it_does_in_time() -> None:
    assert 0.65 < surprise(differ(simulated()[1]), REFLECTOR, rests=True) < 1.5


@needs("linearise.noise_covariance.MOTOR_VISIT")
def a_motor_may_stay_at_the_other_level_for_a_visit_and_five_levels_are_no_friction() -> None:
    stays = np.ones(INSTANTS)
    assert surprise(2 * stays, CURRENT, rests=True) < 1.5
    assert surprise(5 * stays, CURRENT, rests=True) > 2.0


@needs("linearise.noise_covariance.STANDING")
def a_joint_that_stands_holds_up_to_its_level_and_three_levels_are_no_friction() -> None:
    assert surprise(np.ones(INSTANTS), REFLECTOR, rests=False) < 1.5
    assert surprise(3 * np.ones(INSTANTS), REFLECTOR, rests=False) > 2.5


@needs("linearise.noise_covariance.SLOWNESS")
def what_a_joint_holds_changes_slowly() -> None:
    # Its friction may turn round four times in a run by all of its level, and not seven times.
    four, seven = (legendre.legval(np.linspace(-1, 1, INSTANTS), np.eye(8)[k]) for k in (4, 7))
    assert surprise(four, REFLECTOR, rests=False) < 1.5
    assert surprise(seven, REFLECTOR, rests=False) > 3


@needs("linearise.noise_covariance.STIRS")
def a_loose_link_is_stirred_by_little() -> None:
    # Two rests of a visit may differ by a twenty-fifth of the gap, not by a tenth: then a load pushed the link.
    assert surprise(np.array([0.02, -0.02]), REFLECTOR, rests=True, gap=3e-4) < 2
    assert surprise(np.array([0.05, -0.05]), REFLECTOR, rests=True, gap=3e-4) > 2.5


@needs("linearise.noise_covariance.CREEPS")
def a_loose_link_creeps_while_others_move() -> None:
    # By a tenth of its gap either way, and not by a quarter: then it is pushed from flank to flank.
    drift = np.linspace(-1, 1, INSTANTS)
    assert surprise(0.1 * drift, REFLECTOR, rests=False, gap=3e-4) < 3
    assert surprise(0.25 * drift, REFLECTOR, rests=False, gap=3e-4) > 3.5
