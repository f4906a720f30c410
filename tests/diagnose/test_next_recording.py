"""What a diagnosis promises of a recording to come: it covers one more, with what drifts and what was seen twice."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.cross_validation.next_recording import apart, predicted_error
from bench.diagnose.extend.fit import Fit, Unknown
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.nuisances import Nuisance
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE
from bench.record.held_out import BLOCKS
from bench.simulate.instruments import Reading
from tests.diagnose.made_runs import LENGTH, SIGMA, design_with, fit_of, noise, sensitivities

SEEDS = 40
FEWEST = 31  # of 40 at 90 %: binomial, three standard deviations down
OWN = 0.5  # of a gain with a standard deviation of 1, the part that is another one in each recording
GAIN = 120 * SIGMA  # what a gain of 1 changes


def READ(x: float, reading: Reading) -> Reading:  # noqa: N802
    return reading


def test_predicted_error_covers_one_more_run() -> None:
    covered = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        runs = 9
        jacobian = sensitivities(rng, runs, p=1)
        sizes = np.repeat(np.exp(0.5 * rng.standard_normal(runs)), LENGTH)
        linear = design_with(sizes * noise(rng, runs), jacobian, runs)
        (found,) = predicted_error(linear, fit_of(linear))
        assert (found.channel, found.kind, found.runs) == ("current_1_a", "motion", runs)
        assert found.low < found.high
        fresh = np.exp(0.5 * rng.standard_normal()) * SIGMA * rng.standard_normal(LENGTH)
        covered += found.low < np.sqrt(np.mean(fresh**2)) < found.high
    assert 31 <= covered <= 40  # binomial of 40 at 90 %, three standard deviations down


@pytest.mark.parametrize(("times", "is_promised"), [(1.2, True), (3.0, False)])
def test_two_runs_that_differ_promise_nothing(times: float, is_promised: bool, rng: np.random.Generator) -> None:
    """Of half a recording of EMPS "0.00004 to 156172 N" was promised."""
    sizes = np.repeat([1.0, times], LENGTH)
    linear = design_with(sizes * noise(rng, 2), sensitivities(rng, 2, p=1), 2)
    (found,) = predicted_error(linear, fit_of(linear))
    assert np.isfinite([found.low, found.high, found.fitted_low, found.fitted_high]).all() == is_promised
    assert found.rms > 0


def drifting(linear: LinearisedModel, recordings: Sequence[str]) -> LinearisedModel:
    """Return a campaign whose runs are recordings and whose only nuisance drifts: a column for each that it has."""
    (whole,) = {nuisance.sigma for nuisance in linear.nuisances}
    assert whole == 1
    if not recordings:
        return replace(linear, nuisances=(Nuisance("gain", "", 1.0, on_reading=READ, between="drifts", own=OWN),))
    shared = Nuisance("gain", "", float(np.sqrt(1 - OWN**2)), on_reading=READ)
    own = (Nuisance("gain", "", OWN, on_reading=READ, between="drifts", own=OWN, recording=name) for name in recordings)
    segments = tuple(replace(s, recording=name) for s, name in zip(linear.replay.segments, recordings, strict=True))
    replay = type(linear.replay)(segments=segments, quantities=linear.replay.quantities)  # type: ignore[call-arg]
    return replace(linear, nuisances=(shared, *own), replay=replay)


@pytest.mark.parametrize("recordings", [(), ("A", "B", "C", "D")])
def test_what_drifts_is_in_the_interval(recordings: tuple[str, ...]) -> None:
    """A gain whose own part is sixty times the noise: nearly all of the error of one more recording.

    The model has the own part of the last recording, so that counts as well as the own part of the next one.
    """
    covered, narrower = 0, 0
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        runs = len(recordings) or 6
        lasting, own = np.sqrt(1 - OWN**2) * rng.standard_normal(), OWN * rng.standard_normal(runs)
        which = np.repeat(np.arange(runs), LENGTH)
        if recordings:
            columns = np.column_stack([np.sqrt(1 - OWN**2) + 0 * which, *(OWN * (which == i) for i in range(runs))])
        else:
            columns, own = np.ones((len(which), 1)), np.full(runs, own[0])
        linear = design_with(noise(rng, runs) + GAIN * (lasting + own[which]), GAIN * columns, runs)
        (found,) = predicted_error(*_with_fit(drifting(linear, recordings)))
        fresh = SIGMA * rng.standard_normal(LENGTH) + GAIN * (OWN * rng.standard_normal() - own[-1])
        rms = np.sqrt(np.mean(fresh**2))
        covered += found.low < rms < found.high
        narrower += rms < 1.645 * GAIN * OWN  # all that the own part of the next one alone would promise
    assert FEWEST <= covered <= SEEDS
    assert narrower < covered, "else the test says nothing"


def test_friction_held_at_rest_is_in_no_prediction_and_so_in_the_interval(rng: np.random.Generator) -> None:
    """It is the same in all runs and fitted, but nobody hands it over: a prediction has none of it."""
    runs, held = 6, 10 * SIGMA
    pattern = np.tile(rng.standard_normal(LENGTH), runs)
    readings = held * pattern + noise(rng, runs)
    linear = design_with(readings, held * pattern[:, None], runs)
    (found,) = predicted_error(replace(linear, nuisances=(Nuisance("friction held", "", 1.0),)), fit_of(linear))
    assert found.low < np.sqrt(np.mean(readings**2)) < found.high
    linear = replace(linear, nuisances=(Nuisance("an offset", "", 1.0, on_reading=READ),))
    (found,) = predicted_error(linear, fit_of(linear))
    assert found.high < 2 * SIGMA, "what is handed over is in the prediction"


def _with_fit(linear: LinearisedModel) -> tuple[LinearisedModel, Fit]:
    return linear, fit_of(linear)


def test_what_is_set_up_anew_is_in_the_interval_unless_it_is_fitted(rng: np.random.Generator) -> None:
    """An offset that is another one each time, stated within 1 where the noise is 0.2."""
    runs = 6
    linear = design_with(noise(rng, runs), np.ones((runs * LENGTH, 1)), runs)
    linear = replace(linear, nuisances=(Nuisance("zero", "rad", 1.0, on_reading=READ, between="anew", own=1.0),))
    (found,) = predicted_error(linear, fit_of(linear))
    assert found.fitted_high < 2 * SIGMA
    assert found.high == pytest.approx(1.96, rel=0.1), "of a normal offset: 5 % lie beyond, either way"
    assert found.low < found.high / 5


@pytest.mark.parametrize(
    ("effect", "is_in_it", "is_in_fitted"),
    [("channel_scale", True, True), ("tracker_scale", True, False), ("coulomb_level", False, False)],
)
def test_an_error_of_the_recording_is_in_the_interval_and_a_cause_of_the_machine_is_not(
    effect: str, is_in_it: bool, is_in_fitted: bool, rng: np.random.Generator
) -> None:
    """The model has an error that the next recording does not have; `--free` fits those of the tracker alone."""
    runs, change = 6, 20 * SIGMA
    linear = design_with(noise(rng, runs), np.zeros((runs * LENGTH, 0)), runs)
    which = catalogue()[effect]
    unknown = Unknown(Cause(which, WHOLE, which.parameters, ()), which.parameters[0])
    column = np.full((runs * LENGTH, 1, 1), change / 0.05)
    fit = replace(fit_of(linear), causes=(unknown.cause,), unknowns=(unknown,), values=np.array([0.05]))
    fit = replace(fit, jacobian=column, covariance=np.eye(1))
    (found,) = predicted_error(linear, fit)
    assert (found.low < change < found.high) is is_in_it
    assert (found.fitted_low < change < found.fitted_high) is is_in_fitted


def there_and_back(linear: LinearisedModel, back: bool) -> LinearisedModel:
    """Return a campaign of one run whose joint goes there, and back if so."""
    (segment,) = linear.replay.segments
    t = np.linspace(0, 1, len(segment))
    q = np.where(t < 0.5, t, 1 - t) if back else t
    motion = replace(segment.motion, q=q[:, None])
    segments = (replace(segment, motion=motion),)
    replay = type(linear.replay)(segments=segments, quantities=linear.replay.quantities)  # type: ignore[call-arg]
    return replace(linear, replay=replay)


@pytest.mark.parametrize("back", [True, False])
def test_blocks_there_and_back_are_held_out_together(back: bool, rng: np.random.Generator) -> None:
    n = 40 * BLOCKS
    linear = there_and_back(design_with(SIGMA * rng.standard_normal(n), rng.standard_normal((n, 1)), 1), back)
    before = folds_of(linear)
    after = apart(linear, before)
    assert len(after) == (BLOCKS // 2 if back else BLOCKS)
    block = np.arange(n) * BLOCKS // n
    for f in range(len(after)):
        mine = np.unique(block[after.of_instants == f])
        assert mine.sum() == (BLOCKS - 1 if back else mine[0]), "one and its mirror image"
        assert not np.any(after.gap[:, f] & (after.of_instants == f))
        assert np.any(after.gap[:, f])


@pytest.mark.parametrize("back", [True, False])
def test_a_block_is_predicted_by_the_half_of_its_run_that_is_farthest_from_it(
    back: bool, rng: np.random.Generator
) -> None:
    n = 40 * BLOCKS
    linear = there_and_back(design_with(SIGMA * rng.standard_normal(n), rng.standard_normal((n, 1)), 1), back)
    after = apart(linear, folds_of(linear))
    (segment,) = linear.segments
    place = segment.motion.q[:, 0]
    for f in range(len(after)):
        fitted = (after.of_instants != f) & ~after.gap[:, f]
        assert 0.3 * n < np.count_nonzero(fitted) <= 0.5 * n, "but for gaps"
        middle = np.mean(place[after.of_instants == f])
        away = np.abs(place - middle)
        assert np.min(away[fitted]) > np.max(away[after.of_instants == f])
        assert np.median(away[fitted]) > np.median(away)


def repeating(linear: LinearisedModel, programs: int) -> LinearisedModel:
    """Return a campaign of recordings that each go through the same states, one run for each."""
    segments = []
    for i, segment in enumerate(linear.replay.segments):
        q = np.full((len(segment), 1), float(i % programs))
        segments.append(
            replace(segment, motion=replace(segment.motion, q=q), recording=f"recording {i // programs + 1}")
        )
    replay = type(linear.replay)(segments=tuple(segments), quantities=linear.quantities, observed=linear.observed)  # type: ignore[call-arg]
    nuisances = tuple(replace(one, on_reading=READ) for one in linear.nuisances)
    return replace(linear, replay=replay, nuisances=nuisances)


def test_what_a_program_repeats_is_no_promise_for_another_one() -> None:
    """Where figures take half of what the model misses in the states of one program, others are missed by far more.

    A fifth laboratory's joint diagnosis of two recordings by one program promised 0.185 to 0.230 A, and left 0.282 A of
    a third one by another.
    """
    covered, by_repeats = 0, 0
    programs, missed = 6, 10 * SIGMA
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        states = missed * rng.standard_normal((programs + 1) * LENGTH)  # what the model misses, each time
        columns = 30 * sensitivities(rng, programs + 1, p=programs * LENGTH // 2)
        known = slice(0, programs * LENGTH)
        readings = np.tile(states[known], 2) + noise(rng, 2 * programs)
        linear = repeating(design_with(readings, np.tile(columns[known], (2, 1)), 2 * programs), programs)
        fit = fit_of(linear)
        (found,) = predicted_error(linear, fit)
        fresh = states[known.stop :] + SIGMA * rng.standard_normal(LENGTH) - columns[known.stop :] @ fit.nuisances
        rms = float(np.sqrt(np.mean(fresh**2)))
        covered += found.low < rms < found.high
        by_repeats += rms < 2 * found.low
        assert found.low < found.rms < found.high, "of the same program"
    assert covered >= FEWEST
    assert by_repeats < FEWEST, "else the test says nothing"


def test_an_arm_that_stands_is_held_out_by_its_blocks_of_time(rng: np.random.Generator) -> None:
    """Blocks that pass the same places are held out together; of a standing arm there are no places: IndexError."""
    n = 40 * BLOCKS
    linear = there_and_back(design_with(SIGMA * rng.standard_normal(n), rng.standard_normal((n, 1)), 1), True)
    (segment,) = linear.replay.segments
    for shaking in (0.0, 1e-6):
        q = shaking * rng.standard_normal((n, 1))
        stands = replace(segment, motion=replace(segment.motion, q=q))
        replay = type(linear.replay)(segments=(stands,), quantities=linear.replay.quantities)  # type: ignore[call-arg]
        before = folds_of(linear)
        after = apart(replace(linear, replay=replay), before)
        np.testing.assert_array_equal(after.of_instants, before.of_instants)
        np.testing.assert_array_equal(after.gap, before.gap)
