"""How evidence is weighed: what is held out, what counts as noise, and what a finding may be taken for."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.diagnose.cross_validation.folds import Folds, folds_of
from bench.diagnose.cross_validation.leave_out import log_probability_of_figures
from bench.diagnose.cross_validation.next_recording import apart
from bench.diagnose.linearise.lack_of_fit import left_by_nuisances, missed
from bench.diagnose.linearise.roughness import with_roughness
from bench.diagnose.name.simulation_error import imitated
from bench.record.campaign import Array
from tests.diagnose.assumed.registry import needs
from tests.diagnose.made_runs import LENGTH, SIGMA, design_with, fit_of, noise, sensitivities
from tests.diagnose.test_search_space import toy

RUNS = 5


@needs("record.held_out.GAP")
def what_remembers_a_fifth_of_a_block_tells_nothing_of_the_next_one() -> None:
    # No instant that is fitted is nearer to one that is predicted; four fifths of the run are fitted all the same.
    rng = np.random.default_rng(1)
    linear = design_with(noise(rng, 16), sensitivities(rng, 16), 1)  # one run of 192 instants
    folds = folds_of(linear)
    count, when = len(folds), np.arange(16 * LENGTH)
    block = len(when) / count
    for f in range(count):
        own = folds.of_instants == f
        fitted = ~own & ~folds.gap[:, f]
        nearest = np.min(np.abs(when[fitted][:, None] - when[own]))
        assert nearest > block / 5
        assert np.count_nonzero(fitted) >= 0.8 * len(when)


@needs("cross_validation.folds.ALONE")
def others_confirm_what_shows_in_them_by_a_seventh_of_its_power() -> None:
    # What shows by a twentieth of it in other runs is checked in blocks of its own.
    rng = np.random.default_rng(1)
    linear = design_with(noise(rng, RUNS), sensitivities(rng, RUNS), RUNS)

    def held_out_by(share: float) -> str:
        power = np.full(RUNS, share / (RUNS - 1))
        power[0] = 1 - share
        return folds_of(linear, np.repeat(np.sqrt(power), LENGTH)).by

    assert held_out_by(1 / 7) == "run"
    assert held_out_by(1 / 20) == "block"


@needs("cross_validation.leave_out.FAR")
def figures_count_that_data_know_twenty_times_worse_and_not_fifty_times() -> None:
    # Of a figure as it was stated: how probable that is given the data, if they know it so much worse than that.

    def known(times_worse: float) -> float:
        fit: Any = SimpleNamespace(nuisances=np.zeros(1))
        tangent: Any = SimpleNamespace(precision=np.array([[1 / (1 - times_worse**-2)]]), step=np.zeros(1))
        return log_probability_of_figures(fit, tangent)

    assert known(20) > known(1e6) + 0.1
    assert known(50) < known(1e6) + 0.1


@needs("linearise.lack_of_fit.SHARE_OF_MISSES")
def what_a_poor_model_misses_counts_as_two_standard_errors_of_each_reading() -> None:
    # Signatures about a wrong model are good to a share of it: ten readings still tell 20 nats, not 80.
    white = np.random.default_rng(2).standard_normal(RUNS * LENGTH) * 100 * SIGMA
    linear = design_with(white, np.zeros((RUNS * LENGTH, 1)), RUNS)
    errors = float(missed(linear, left_by_nuisances(linear, linear.white))[1, 0])
    each = float(np.sqrt(np.mean(linear.white**2))) / errors
    assert 1.5 < each < 3.0


@needs("linearise.roughness.WINDOW")
def roughness_is_that_of_a_place_and_is_known_to_a_third() -> None:
    rng, sigma = np.random.default_rng(3), np.ones((3000, 1))
    rough = with_roughness(5 * rng.standard_normal((3000, 1)), sigma)[50:-50]
    assert np.std(np.log(rough)) < 0.45
    burst = np.zeros((60, 1))
    burst[30] = 20.0
    raised = with_roughness(burst, np.ones((60, 1))) > 1
    assert np.count_nonzero(raised) <= 13


@needs("name.search_space.GREATER_PART")
def a_cause_that_explains_more_than_half_of_what_a_shape_does_is_kept() -> None:
    # A shape that explains more is preferred to one that explains 40 % of it, not to one that explains 60 %.
    rng = np.random.default_rng(5)
    cause, rest = np.linalg.qr(rng.standard_normal((60, 2)))[0].T

    def is_kept(share: float) -> bool:
        signal = 30 * (np.sqrt(share) * cause + np.sqrt(1 - share) * rest)
        return not toy(signal, cause, signal / 8).instead((0,))

    assert is_kept(0.6)
    assert not is_kept(0.4)


@needs("name.simulation_error.SIMULATED")
def what_is_simulated_to_a_hundredth_and_a_half_imitates_a_finding_and_to_a_thirtieth_does_not() -> None:
    # Evidence that such an error in all others would leave, beside what `imitated` expects at most.
    rng = np.random.default_rng(6)
    column = rng.standard_normal(RUNS * LENGTH)
    linear = design_with(noise(rng, RUNS) + column, sensitivities(rng, RUNS), RUNS)
    best, null = fit_of(linear, column), fit_of(linear)
    explained = float(np.sum(linear.whiten(null.residual - best.residual) ** 2))
    small = replace(best, residual=best.residual + 0.01 * (null.residual - best.residual))
    most = imitated(linear, null, best, small)
    assert 0.5 * 0.015**2 * explained < most < 0.5 * explained / 30**2


@needs("replay.alike.ALIKE")
def a_way_back_beside_the_way_out_passes_the_same_places() -> None:
    # Within 1.5 % of what the joints pass in all, and not within 3 %.

    def is_same(beside: float) -> bool:
        there = np.linspace(0, 1, 200)
        out, back = np.stack([there, 0 * there], axis=1), np.stack([1 - there, 0 * there + beside], axis=1)
        elsewhere = np.stack([there, 0.5 + 0.5 * there], axis=1)
        q = np.concatenate([out, back, elsewhere])
        motion = SimpleNamespace(q=q, read=np.ones(len(q), dtype=bool))
        linear: Any = SimpleNamespace(segments=[SimpleNamespace(motion=motion)])
        blocks: Array = np.repeat(np.arange(3), 200)
        return len(apart(linear, Folds("block", blocks, np.zeros((len(q), 3), dtype=bool)))) == 2

    assert is_same(0.015)
    assert not is_same(0.03)
