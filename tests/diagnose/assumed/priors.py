"""Prior widths and errors of instruments: what is ordinary, and what is not, in standard deviations."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.noise import Noise
from bench.diagnose.replay.nuisances import Nuisance, nuisances_of
from bench.diagnose.replay.quantities import Quantity
from bench.effects.conditions import REFERENCE_K
from bench.effects.drifts import own_part
from tests.diagnose.assumed.registry import needs
from tests.diagnose.sweeps import nominal

GAS = Quantity("gas_temperature_k", "gas_temperature", "K")
LINK = Quantity("q_link_1_rad", "q_link", "rad")
BETWEEN_TWO = np.sqrt(2)  # the difference of two draws scatters by so much more


def prior(name: str, recordings: tuple[str, ...] = ("A",)) -> Nuisance:
    """Return the first background error of a name, as one recording has it."""
    compiled = nominal()
    every = with_recordings(nuisances_of(compiled, (GAS,)), compiled, recordings)
    return next(one for one in every if one.name == name and (len(recordings) == 1 or one.recording is not None))


def noise() -> Noise:
    """Return the noise of a lab that states none."""
    campaign: Any = SimpleNamespace(noise={})
    return Noise(campaign, nominal().robot.figures)


@needs("effects.drifts.AIR_DAY_K")
def gas_is_ten_kelvin_warmer_on_another_day_and_not_twenty() -> None:
    sigma = BETWEEN_TWO * prior("temperature of the gas", ("A", "B")).sigma
    assert 10.0 / sigma < 2.0 < 20.0 / sigma


@needs("replay.nuisances.THERMOMETER_K")
def a_thermometer_tells_gas_that_was_lost_from_gas_that_is_cold() -> None:
    # It sits on the wall, and may be 3 K off; but that a fortieth of the gas is gone shows with three sigma.
    sigma = prior("thermometer of the gas").sigma
    assert 3.0 / sigma < 2.0
    assert REFERENCE_K / 40 / sigma > 3.0


@needs("replay.noise.GAS_DRIFT_K")
def gas_and_wall_drift_apart_by_a_kelvin_and_a_half_in_hours_and_not_by_three() -> None:
    assert 1.5 / noise().lasting(GAS) < 2.0 < 3.0 / noise().lasting(GAS)


@needs("replay.noise.LINK_ENCODER")
def a_link_encoder_resolves_what_ten_newton_metres_twist() -> None:
    # And it is no better than what 21 bits round.
    run: Any = None
    (sigma,) = noise().of(LINK, np.zeros(1), run)
    assert sigma > 2 * np.pi / 2**21 / np.sqrt(12)
    assert 10.0 / np.max(nominal().stiffness) / sigma > 3.0


@needs("effects.drifts.DAY_K")
def a_warmed_up_drive_is_one_that_was_cold() -> None:
    # Twenty kelvin between two recordings are ordinary: 30 % of viscous friction. 50 K are not.
    assert 0.3 / (BETWEEN_TWO * prior("viscous friction of joint2", ("A", "B")).sigma) < 2.0
    assert 50 * 0.001 / (BETWEEN_TWO * own_part("current_gain", 1.0)) > 3.0


@needs("effects.drifts.COULOMB")
def a_tenth_of_coulomb_friction_comes_and_goes_and_thirty_per_cent_do_not() -> None:
    sigma = prior("Coulomb friction of joint2", ("A", "B")).sigma
    assert 0.1 / (BETWEEN_TWO * sigma) < 2.0
    assert 0.3 / (BETWEEN_TWO * sigma) > 3.0


@needs("effects.drifts.DRIFTING")
def what_lasts_of_a_zero_and_what_drifts_are_of_one_order() -> None:
    drifts = own_part("current_offset", 1.0)
    assert 0 <= drifts <= 1
    assert drifts == pytest.approx(np.sqrt(1 - drifts**2), rel=0.3)


@needs("replay.noise.MOST_ALIKE")
def noise_that_remembers_counts_and_a_slow_signal_is_none() -> None:
    # Neighbours that are correlated by 0.7 average out less, as bins of two hundred samples show.
    rng, count, size = np.random.default_rng(4), 100, 200
    white = rng.standard_normal(count * size)
    coloured = np.zeros_like(white)
    for i in range(1, len(white)):
        coloured[i] = 0.7 * coloured[i - 1] + np.sqrt(1 - 0.7**2) * white[i]
    slow = np.sqrt(2) * np.sin(2 * np.pi * np.arange(len(white)) / 100)
    groups = np.split(np.arange(len(white)), count)
    of_coloured, of_slow = Noise.of_groups(np.stack([coloured, slow], axis=1), groups)
    assert of_coloured == pytest.approx(np.sqrt(1.7 / 0.3), rel=0.2)
    assert of_slow < 4.0  # samples of a standard deviation of one
