"""How much of its friction a standing joint takes anew from instant to instant."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.linearise.noise_covariance import SLOWNESS, slow
from bench.diagnose.linearise.standing_joints import ANYWHERE, shaken_share
from bench.effects.catalogue import catalogue
from tests.diagnose.sweeps import SWEEPS, made, nominal

LEVELS = np.array([40.0, 100.0])  # [Nm], of two joints on the link side
NOISE = 1e-5
INSTANTS = 400


class Moving(SimpleNamespace):
    """A motion with as many instants as it has standard errors."""

    is_static = False

    def __len__(self) -> int:
        return len(self.sigma)


def shares(share: float, rng: np.random.Generator, bend: float = 0.0, instants: int = INSTANTS) -> float:
    """Return what is found of jumps by `share` of joint 2, which stands, beside noise and a smooth misfit."""
    over = np.linspace(0, 1, instants)
    link = np.zeros((instants, 1, 2))
    link[:, 0, 1] = 2e-6 * (1 + over)  # [m/Nm]
    jumps = share * LEVELS[1] * link[:, 0, 1] * rng.standard_normal(instants)
    left = jumps + bend * np.sin(6 * over) + NOISE * rng.standard_normal(instants)
    segment: Any = Moving(standing=np.array([False, True]), sigma=np.full((instants, 1), NOISE))
    response: Any = SimpleNamespace(link=link, motor=np.zeros((instants, 1, 2)))
    compiled: Any = SimpleNamespace(link_coulomb=LEVELS, motor_coulomb=np.zeros(2))
    quantity: Any = SimpleNamespace(is_drive=False)
    return shaken_share(compiled, [segment], [response], [quantity], [left[:, None]])


@pytest.mark.parametrize("share", [0.1, 0.3])
def test_jumps_are_found_beside_noise_and_misfit(share: float, rng: np.random.Generator) -> None:
    found = [shares(share, rng, bend=1e-3) for _ in range(20)]
    assert np.mean(found) == pytest.approx(share, rel=0.1)


def test_noise_and_misfit_are_no_jumps(rng: np.random.Generator) -> None:
    assert max(shares(0.0, rng, bend=1e-3) for _ in range(20)) < 0.03  # jumps of 0.2 of the noise


def test_without_motion_enough_a_joint_may_be_anywhere(rng: np.random.Generator) -> None:
    assert shares(0.1, rng, instants=20) == pytest.approx(2 * ANYWHERE)


def test_friction_that_walks_over_a_level_is_followed_to_a_tenth(rng: np.random.Generator) -> None:
    walk = np.cumsum(rng.standard_normal((INSTANTS, 200)), axis=0) / np.sqrt(INSTANTS)
    for columns, left in ((slow(INSTANTS), 0.1), (slow(INSTANTS)[:, :SLOWNESS], 0.2)):
        sizes = np.linalg.lstsq(columns, walk, rcond=None)[0]
        assert np.sqrt(np.mean((walk - columns @ sizes) ** 2)) == pytest.approx(left, rel=0.3)
    assert slow(3).shape[0] == 3


def test_corners_of_friction_at_the_wrist_are_no_hysteresis() -> None:
    campaign = made(SWEEPS, 3_000_002, machine=3000)  # 37 nats for hysteresis of joint 5, with polynomials alone
    effects = {name: catalogue()[name] for name in ("hysteresis", "friction_side", "softening", "gas_loss")}
    assert diagnose(campaign, nominal(), effects, proposes=False).verdict.kind == "nothing found"
