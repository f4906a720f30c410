"""What is stated of weights holds for each of them: one that errs within it is no load that was written down wrong."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.experiment_design.experiments import Experiment
from bench.diagnose.experiment_design.preposterior import Preposterior
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.each_weight import MOST_WEIGHTS, each_weight
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.nuisances import Nuisance
from tests.diagnose.noise_free import linearised
from tests.diagnose.small_models import chi_square_left
from tests.diagnose.sweeps import LOADS, made

OFF = 0.002  # two standard deviations of what is stated
HUNG = "weights that hang"


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    return linearised(made(LOADS, seed=5))


def changes_of(linear: LinearisedModel, start: str) -> dict[str, np.ndarray]:
    return {
        one.name: linear.sensitivities[:, :, i] for i, one in enumerate(linear.nuisances) if one.name.startswith(start)
    }


def test_weights_that_each_err_add_up_to_all_of_them(linear: LinearisedModel) -> None:
    """Where they hang; what friction remembers of one that was taken off is left out."""
    own = changes_of(linear, f"{HUNG}, that of")
    assert set(own) == {f"{HUNG}, that of 700 N", f"{HUNG}, that of 1400 N"}
    loaded = np.concatenate([np.any(one.motion.wrench[one.motion.read] != 0, axis=1) for one in linear.segments])
    assert 0 < np.sum(loaded) < len(loaded)
    np.testing.assert_allclose(sum(own.values())[loaded], changes_of(linear, HUNG)[HUNG][loaded], atol=1e-12)
    one, other = own.values()
    assert not np.any((one != 0) & (other != 0))


def test_one_weight_that_is_off_is_its_own_error_and_not_that_of_a_run(linear: LinearisedModel) -> None:
    """A weight 2 sigma off was 63 nats that something is wrong (`-s` prints them); now it costs what its prior says."""
    change = changes_of(linear, f"{HUNG}, that of 1400 N")[f"{HUNG}, that of 1400 N"] / 0.001 * OFF
    shift = linear.whiten(change)
    known = {"in common": f"{HUNG}, that of", "each": "nothing"}
    evidence = {title: 0.5 * chi_square_left(linear, shift, without) for title, without in known.items()}
    print({title: f"{nats:.1f} nats" for title, nats in evidence.items()})
    assert evidence["each"] < 2.0 + 1e-6  # exact: half the square of two standard deviations
    assert evidence["in common"] > 9.0


def test_a_pull_that_changes_all_the_time_is_no_set_of_weights(linear: LinearisedModel) -> None:
    segments, start = [], 0
    for segment in 2 * linear.segments:
        motion = segment.motion
        pull = np.zeros(len(motion))
        pull[motion.read] = 100.0 * 1.1 ** np.arange(start, start + len(segment))
        start += len(segment)
        segments.append(replace(segment, motion=replace(motion, wrench=np.outer(pull, [0, 0, -1, 0, 0, 0]))))
    assert start > MOST_WEIGHTS
    common = Nuisance(HUNG, "", 0.001, scales_wrench=True)
    found, changes = each_weight(segments, [common], np.ones((start, 1, 1)))
    assert found == ()
    assert changes.shape[2] == 0


def test_an_experiment_that_is_done_again_hangs_the_same_weights(linear: LinearisedModel) -> None:
    """What is expected of it knew of no single weight, and so promised more than there is to learn."""
    again = Experiment("again", "again", linear.segments)
    (expected,) = Preposterior(linear, (refit(linear, (), {}),), (again,), linear.quantities, is_quick=False).expect(
        again
    )
    own = [i for i, one in enumerate(linear.nuisances) if one.name.startswith(f"{HUNG}, that of")]
    assert len(own) == 2
    np.testing.assert_allclose(
        np.linalg.norm(expected.jacobian[:, own], axis=0), np.linalg.norm(linear.jacobian[:, own], axis=0), rtol=1e-6
    )
