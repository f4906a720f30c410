"""What a first pass predicts of averages over samples, and joints that stand."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identify.dynamics.averages import averages_of
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.samples import LONGEST, motion_samples
from bench.record.campaign import Array, Campaign, Run
from tests.identify.dynamics.rigid_world import Friction, N, arm, fourier, recorded, robot, torque_of

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.array([0.5, -1.0, 0.8]))
WIDTH = 20  # samples of a bin, 0.1 s


def bins_of(run: Run) -> list[tuple[Array, Array]]:
    """Return bins as a replay has them: their times, and equal weights."""
    return [(time, np.full(WIDTH, 1 / WIDTH)) for time in np.split(run.columns["time_s"], len(run) // WIDTH)]


@pytest.mark.parametrize("late", [0.0, 0.02])
def test_averages_are_those_of_the_measured_torque(late: float) -> None:
    """Without noise the averages of each bin come out, as they were read: late where the torques are."""
    rng = np.random.default_rng(2)
    nominal = robot(arm())
    campaign = recorded(nominal, FRICTION, rng, sigma=1e-3, late=late)
    found = first_pass(campaign, nominal)
    assert found.solution.delay == pytest.approx(late, abs=1e-3)
    run = campaign.runs[1]
    bins = bins_of(run)
    (averages,) = averages_of(found, run.name, bins)
    predicted = averages.torque(found.parameters)
    measured = np.stack([run.columns[f"tau_motor_{j + 1}_nm"] for j in range(N)], axis=1)
    mean = measured.reshape(len(bins), WIDTH, N).mean(axis=1)[averages.which]
    assert len(averages.which) > 0.8 * len(bins)  # but for one period of the cut-off at either end
    assert np.mean(np.isfinite(predicted)) > 0.7  # where a drive turns round it is not predicted
    error = predicted - mean
    rms = np.sqrt(np.nanmean(error**2, axis=0))
    assert np.all(rms < 0.02 * np.std(mean, axis=0))


def test_bins_at_the_ends_and_of_other_runs_are_left_out() -> None:
    nominal = robot(arm())
    campaign = recorded(nominal, FRICTION, np.random.default_rng(2), runs=2, seconds=10.0)
    found = first_pass(campaign, nominal)
    bins = bins_of(campaign.runs[0])
    (averages,) = averages_of(found, "run0", bins)
    edge = 1 / found.band.cutoff_hz
    inside = [k for k, (time, _) in enumerate(bins) if edge <= time[0] and time[-1] <= 10.0 - edge]
    assert abs(len(averages.which) - len(inside)) <= 2
    assert averages_of(found, "another", bins) == ()


def test_noise_of_an_encoder_is_no_motion() -> None:
    """A joint that stands holds any friction torque; its rows would tell a payload that is not there."""
    rng = np.random.default_rng(3)
    nominal = robot(arm(), payload=20.0)
    time, q, velocity, acceleration = fourier(rng, seconds=20.0)
    for values in (q, velocity, acceleration):
        values[:, 1] = 0.0
    torque = torque_of(nominal, q, velocity, acceleration) + FRICTION.torque(velocity)
    torque[:, 1] += 40.0  # static friction that holds
    columns = {"time_s": time}
    columns |= {f"q_motor_{j + 1}_rad": q[:, j] + 1e-5 * rng.standard_normal(len(q)) for j in range(N)}
    columns |= {f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(N)}
    found = first_pass(Campaign("rigid", (Run("only", "motion", 0.0, columns),)), nominal)
    assert [len(rows) > 0 for rows in found.rows(found.stretches)] == [True, False, True]
    assert np.isnan(found.held_out.rms("first_pass")[1])


def test_a_long_run_is_cut() -> None:
    nominal = robot(arm())
    rows = LONGEST + 1000
    columns = {"time_s": np.arange(rows) / 500}
    columns |= {f"q_motor_{j + 1}_rad": np.sin(columns["time_s"]) for j in range(N)}
    columns |= {"tau_motor_1_nm": np.zeros(rows)}
    run = Run("long", "motion", 0.0, columns)
    one, other = motion_samples(Campaign("rigid", (run,)), nominal)
    assert len(one) + len(other) == rows
    assert other.time[0] > one.time[-1]
    short = replace(run, columns={key: values[:LONGEST] for key, values in columns.items()})
    assert len(motion_samples(Campaign("rigid", (short,)), nominal)) == 1
