"""What held-out runs say of an extension: what pays and what does not, and its errors beside others."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from bench.diagnose.cross_validation.floor import floor_variance
from bench.diagnose.cross_validation.held_out import RecordingGain, held_out
from tests.diagnose.made_runs import LENGTH, SIGMA, UNKNOWN, design_with, fit_of, in_recordings, noise, sensitivities
from tests.report.diagnosis import made


def test_a_recording_that_denies_a_finding_is_named(rng: np.random.Generator) -> None:
    column = rng.standard_normal(2 * LENGTH)
    for share, confirmed in ((1.0, ["run0", "run1"]), (-1.0, [])):
        residual = noise(rng, 2) + 0.3 * column * np.repeat([1.0, share], LENGTH)
        linear = in_recordings(design_with(residual, np.zeros((2 * LENGTH, 1)), 2), (None,))
        gain = held_out(linear, fit_of(linear), fit_of(linear, column))
        assert gain.by == "recording"
        assert [one.recording for one in gain.recordings if one.confirms] == confirmed
        assert gain.is_gain == bool(confirmed)


def test_a_recording_that_says_next_to_nothing_does_not_confirm() -> None:
    """The second KR300 recording gained 0.24 nats by a transmission error of axis 1, and was told to confirm it."""
    for nats, confirms in ((0.24, False), (1.0, False), (1.2, True), (-5.0, False), (float("nan"), False)):
        assert RecordingGain("b", nats).confirms == confirms


def test_what_one_recording_shows_is_told_of_its_own_readings(rng: np.random.Generator) -> None:
    """A payload of one of two recordings was said to lower 2263 to 1538 Nm: the other was predicted without its own."""
    here, there = (np.repeat(part, LENGTH) for part in ([1.0, 0.0], [0.0, 1.0]))
    column, own = here * 20 * rng.standard_normal(2 * LENGTH), there * 5 * rng.standard_normal(2 * LENGTH)
    linear = in_recordings(design_with(noise(rng, 2) + 0.1 * column + 2 * own, own[:, None], 2), ("run1",))
    found = held_out(linear, fit_of(linear), fit_of(linear, column))
    assert found.of == "run0"
    (channel,) = found.channels
    assert channel.before == pytest.approx(np.sqrt(np.mean(linear.residual[:LENGTH] ** 2)))
    assert channel.nominal == pytest.approx(channel.before)
    assert channel.after < 1.5 * channel.floor


def test_a_true_extension_pays_and_an_invented_one_does_not() -> None:
    runs, refused = 10, 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        jacobian, column = sensitivities(rng, runs), rng.standard_normal(runs * LENGTH)
        true = design_with(noise(rng, runs) + 0.15 * column, jacobian, runs)
        assert held_out(true, fit_of(true), fit_of(true, column)).is_gain
        null = design_with(noise(rng, runs), jacobian, runs)
        refused += not held_out(null, fit_of(null), fit_of(null, column)).is_gain
    assert refused >= 17  # an interval of 90 % lets one in twenty pass on each side


def test_what_one_run_shows_and_the_others_deny_is_refused(rng: np.random.Generator) -> None:
    runs = 10
    column = rng.standard_normal(runs * LENGTH)
    residual = noise(rng, runs)
    residual[:LENGTH] += 1.5 * column[:LENGTH]  # a glitch
    linear = design_with(residual, sensitivities(rng, runs), runs)
    before, after = fit_of(linear), fit_of(linear, column)
    fell = np.sum(linear.whiten(before.residual) ** 2) - np.sum(linear.whiten(after.residual) ** 2)
    assert fell > 20  # the fit alone would take it: log evidence above 4.6 after the price of one parameter
    found = held_out(linear, before, after)
    assert found.by == "run"
    assert not found.is_gain


def test_two_runs_of_twenty_are_enough(rng: np.random.Generator) -> None:
    runs = 20
    column = np.zeros(runs * LENGTH)
    column[: 2 * LENGTH] = rng.standard_normal(2 * LENGTH)
    linear = design_with(noise(rng, runs) + 0.5 * column, sensitivities(rng, runs), runs)
    found = held_out(linear, fit_of(linear), fit_of(linear, column))
    assert found.by == "run"
    assert found.is_gain


def test_an_absurd_figure_does_not_stand_in_for_a_cause(rng: np.random.Generator) -> None:
    runs = 10
    jacobian = sensitivities(rng, runs)
    column = jacobian[:, 0] * 10 / UNKNOWN.sigma  # it acts exactly as the first nuisance
    linear = design_with(noise(rng, runs) + 10 * jacobian[:, 0], jacobian, runs)
    found = held_out(linear, fit_of(linear), fit_of(linear, column))
    assert abs(found.nats - found.figures) < 2  # runs alone cannot tell
    assert found.is_gain
    assert found.channels[0].gain > 0.4
    within = design_with(noise(rng, runs) + 0.5 * jacobian[:, 0], jacobian, runs)
    assert not held_out(within, fit_of(within), fit_of(within, column)).is_gain


def test_what_changes_nothing_does_not_pay(rng: np.random.Generator) -> None:
    linear = design_with(noise(rng, 4), sensitivities(rng, 4), 4)
    found = held_out(linear, fit_of(linear), fit_of(linear, np.zeros(4 * LENGTH)))
    assert found.nats == pytest.approx(0.0, abs=1e-9)
    assert not found.is_gain


def test_a_perfect_model_is_as_good_as_its_floor() -> None:
    runs = 40
    rng = np.random.default_rng(3)
    modes = np.linspace(0.1, 0.5, LENGTH)[:, None]
    shared = np.concatenate([modes[:, 0] * rng.standard_normal() for _ in range(runs)])
    linear = design_with(noise(rng, runs) + shared, 1e-9 * sensitivities(rng, runs), runs, modes)
    expected = np.tile(SIGMA**2 + modes[:, 0] ** 2, runs)
    np.testing.assert_allclose(floor_variance(linear)[:, 0], expected)
    channel = held_out(linear, fit_of(linear), fit_of(linear)).channels[0]
    assert channel.after / channel.floor == pytest.approx(1.0, abs=0.12)  # 40 draws of a mode: 3 % to 5 % each way
    assert channel.gain == pytest.approx(0.0, abs=1e-9)


def test_the_nominal_model_as_it_stands_and_what_was_measured_stand_beside_the_gain(rng: np.random.Generator) -> None:
    runs = 6
    column = rng.standard_normal(runs * LENGTH)
    linear = design_with(noise(rng, runs) + 2 * column + 0.7, sensitivities(rng, runs), runs)
    (found,) = held_out(linear, fit_of(linear), fit_of(linear, column)).channels
    # all readings weigh alike here, and the replay of this made-up campaign predicts nothing at all
    assert found.nominal == pytest.approx(np.sqrt(np.mean(linear.residual**2)))
    # a current is what it is, as in the table beside least squares: "539.3 -> 2.3 Nm of 304.8 measured" was neither
    assert found.measured == pytest.approx(found.nominal)
    angle = replace(linear.quantities[0], column="q_link_1_rad", kind="q_link", unit="rad")
    replay = SimpleNamespace(**{**vars(linear.replay), "quantities": (angle,)})
    linear = replace(linear, replay=replay)  # type: ignore[arg-type]
    (found,) = held_out(linear, fit_of(linear), fit_of(linear, column)).channels
    assert found.measured == pytest.approx(np.std(linear.residual))  # its zero is one of the frame


def test_a_nominal_model_that_the_other_runs_bend_is_no_straw_man(rng: np.random.Generator) -> None:
    jacobian = sensitivities(rng, 2, p=1)
    away = np.repeat([3.0, -3.0], LENGTH)  # two runs that want the opposite of the same figure
    linear = design_with(noise(rng, 2) + away * jacobian[:, 0], jacobian, 2)
    before, after = fit_of(linear), fit_of(linear, away * jacobian[:, 0])
    (found,) = held_out(linear, before, after).channels
    assert found.before > 1.5 * found.nominal
    assert found.over_better == pytest.approx(1 - found.after / found.nominal)
    assert found.over_better_low < found.over_better < found.over_better_high


def test_raised_errors_do_not_raise_the_floor(rng: np.random.Generator) -> None:
    linear = design_with(noise(rng, 3), sensitivities(rng, 3), 3)
    heavier = replace(
        linear,
        weighed=tuple(replace(s, sigma=2 * s.sigma) for s in linear.weighed),
        whitenings=tuple(replace(w, factors=w.factors / 2) for w in linear.whitenings),
        inflation=np.full((2, 1), 2.0),
    )
    np.testing.assert_allclose(floor_variance(heavier), floor_variance(linear))


def test_what_a_channel_loses_is_log_probability(rng: np.random.Generator) -> None:
    before, after = rng.standard_normal((2, LENGTH)) * [[1.3], [1.5]]
    left, more = (float(np.sqrt(np.mean(one**2))) for one in (before, after))
    one = replace(made.STEP_GAIN, before=2e-3 * left, floor=2e-3, high=1 - more / left, readings=LENGTH)
    lost = float(np.sum(norm.logpdf(before) - norm.logpdf(after)))
    assert one.lost == pytest.approx(lost)
    assert replace(one, high=1 - left / more).lost == 0.0
