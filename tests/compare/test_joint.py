"""All recordings in one model: which states coincide, and the covariance that follows."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bench.compare.coincidence import cells_of
from bench.compare.joint import Joint, joint_of, recorded_in_any
from bench.compare.levels import EVERY, by_level, is_of_machine
from bench.compare.noise import Repeatability, variances
from bench.compare.recordings import recordings_of
from bench.compare.shared import shared_whitening
from bench.diagnose.replay.noise import GAS_DRIFT_K
from bench.diagnose.replay.nuisances import THERMOMETER, THERMOMETER_K
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.record.campaign import Campaign
from bench.record.known import Known
from bench.scenario.files import Experiment
from tests.diagnose.sweeps import LOADS, SWEEP, changed, made, nominal

FEW = {name: catalogue()[name] for name in ("gas_loss", "coulomb_level")}
FASTER = SWEEP.model_copy(update={"speeds_deg_per_s": (30.0,)})


@cache
def joint(kind: str) -> Joint:
    before: Experiment = LOADS if kind == "loads" else SWEEP
    after: Experiment = FASTER if kind == "other motion" else before
    recordings = recordings_of({"before": made(before, 1, machine=3)}, {"after": made(after, 2, machine=3)})
    return joint_of(recordings, nominal(), FEW, most_bins=60)


def cells(kind: str) -> np.ndarray:
    return cells_of(joint(kind).linear.segments, joint(kind).of_segment)


def test_the_same_motion_meets_its_states_again() -> None:
    for kind in ("sweep", "loads"):
        found, of = cells(kind), joint(kind).of_instant
        half = int(np.sum(of == 0))
        np.testing.assert_array_equal(found[:half], np.arange(half))
        np.testing.assert_array_equal(found[half:], np.arange(half))


def test_other_speeds_are_other_states() -> None:
    assert len(np.unique(cells("other motion"))) == len(cells("other motion"))


def without(campaign: Campaign, *kinds: str) -> Campaign:
    """Return a campaign without the channels whose names begin so."""

    def drop(columns: dict[str, np.ndarray]) -> None:
        for name in [name for name in columns if name.startswith(kinds)]:
            del columns[name]

    return changed(campaign, drop)


def test_what_one_side_alone_read_says_nothing_of_a_change() -> None:
    whole = made(SWEEP, 1, machine=3)
    few = without(whole, "reflector", "force", "moment", "gas")
    own = joint_of(recordings_of({"before": few}, {"after": made(SWEEP, 2, machine=3)}), nominal(), FEW, most_bins=60)
    assert {one.kind for one in own.linear.quantities} == {"current"}
    assert {name.split("_")[0] for name in own.left_out} == {"reflector", "force", "moment", "gas"}
    assert not joint("sweep").left_out


def test_what_is_bolted_on_is_no_better_known_than_it_was_weighed() -> None:
    before, after = (made(SWEEP, seed, machine=3) for seed in (1, 2))
    weighed = replace(after, known=(Known("payload_kg", 50.0, 1.0),))
    (bolted,) = (one for one in joint("sweep").linear.nuisances if one.scales_payload)
    own = joint_of(recordings_of({"before": before}, {"after": weighed}), nominal(), FEW, most_bins=60)
    (known,) = (one for one in own.linear.nuisances if one.scales_payload)
    assert bolted.sigma < 0.02 == known.sigma == known.own


def test_nothing_read_on_both_sides_is_an_error() -> None:
    before = without(made(SWEEP, 1, machine=3), "reflector", "force", "moment", "gas")
    after = without(made(SWEEP, 2, machine=3), "current")
    with pytest.raises(InputError, match="both before and after"):
        joint_of(recordings_of({"before": before}, {"after": after}), nominal(), FEW)


def test_there_and_back_are_other_states() -> None:
    segments = joint("sweep").linear.segments
    found = cells_of(segments[:2], np.arange(2))
    assert len(np.unique(found)) == len(found)


def test_what_is_set_up_anew_is_anew_in_each_recording() -> None:
    own = joint("sweep")
    linear = own.linear
    machine = sum(is_of_machine(one) for one in linear.nuisances)
    rests = sum(not one.is_simulated for one in linear.nuisances)
    assert any(one.name.startswith("tracker frame") and not is_of_machine(one) for one in linear.nuisances)
    slopes = by_level(linear.jacobian, linear.nuisances, own.of_row, 0.5).matrix
    drifting = sum(is_of_machine(one) and one.own > 0 for one in linear.nuisances)
    assert drifting > 0
    most = machine + rests + 2 * (len(linear.nuisances) - machine + drifting)
    assert machine < slopes.shape[1] <= most
    alone = [np.unique(own.of_row[column != 0]) for column in slopes.T]
    assert sum(len(one) == 1 for one in alone) > machine / 4
    # friction at rest keeps its whole variance, whatever the share that is new in each recording; so does all else, but
    # for the drift of viscous friction, which comes on top of what is stated
    drifts = [one.edit is not None and one.between == "drifts" for one in linear.nuisances]
    whole = np.array(
        [1 + (one.own / one.sigma) ** 2 if more else 1.0 for one, more in zip(linear.nuisances, drifts, strict=True)]
    )
    held = np.array([not one.is_simulated for one in linear.nuisances])
    for share in (0.0, 0.3, 1.0):
        variance = np.sum(by_level(linear.jacobian, linear.nuisances, own.of_row, share).matrix ** 2, axis=1)
        np.testing.assert_allclose(variance, linear.jacobian**2 @ whole, rtol=1e-9, err_msg=str(share))
    assert np.any(held)


def test_what_repeats_has_the_covariance_that_is_said_of_it() -> None:
    for kind in ("sweep", "loads"):
        own = joint(kind)
        linear, found = own.linear, cells(kind)
        c = len(linear.quantities)
        shared = np.tile(np.linspace(0.5, 9.0, c), (2, 1))
        known = Repeatability(np.ones((2, c)), shared, np.ones((2, c), dtype=np.intp))
        whitening = shared_whitening(linear, known, found)
        m = len(linear.white)
        # in the space of the instants' own whitening: I + sum over cells of f f'; then what segments have in common
        rest, instant = linear.kind_of, linear.instant_of
        sigma = np.concatenate([segment.sigma for segment in linear.weighed])[instant, linear.column_of]
        _, cell = np.unique(found[instant] * c + linear.column_of, return_inverse=True)
        features = np.zeros((m, int(cell.max()) + 1))
        mean = np.bincount(cell, sigma) / np.bincount(cell)
        features[np.arange(m), cell] = np.sqrt(shared[rest, linear.column_of]) * mean[cell] / sigma
        edges = np.cumsum([0, *(len(one.modes) for one in linear.whitenings)])
        for one, start, end in zip(linear.whitenings, edges[:-1], edges[1:], strict=True):
            one.settle(features[start:end])
        covariance = np.eye(m) + features @ features.T
        whitened = whitening(whitening(covariance).T)
        np.testing.assert_allclose(whitened, np.eye(m), atol=1e-8)
        determinant = np.linalg.slogdet(covariance)[1]
        gained = whitening.log_determinant - float(np.sum(linear.log_determinants))
        np.testing.assert_allclose(gained, -0.5 * determinant, rtol=1e-6, atol=1e-6)


def test_a_thermometer_is_the_same_one_on_the_next_day() -> None:
    """Gas that was 2.7 K warmer, as its thermometer showed, shared the odds with gas that was lost."""

    def with_thermometer(campaign: Campaign) -> Campaign:
        return changed(
            campaign, lambda columns: columns.update(gas_temperature_k=np.full(len(columns["time_s"]), 294.0))
        )

    recordings = recordings_of(
        {"before": with_thermometer(made(SWEEP, 1))}, {"after": with_thermometer(made(SWEEP, 2))}
    )
    own = joint_of(recordings, nominal(), FEW, most_bins=60)
    linear = own.linear
    slopes = by_level(linear.jacobian, linear.nuisances, own.of_row, 0.5)
    (mine,) = (i for i, one in enumerate(linear.nuisances) if one.name == THERMOMETER)
    columns = np.flatnonzero(slopes.nuisance == mine)
    size = [float(np.max(np.abs(slopes.matrix[:, column]))) for column in columns]
    assert slopes.recording[columns].tolist() == [EVERY, 0, 1]
    assert size[0] / size[1] == pytest.approx(np.sqrt(THERMOMETER_K**2 - GAS_DRIFT_K**2) / GAS_DRIFT_K)
    assert size[1] == pytest.approx(size[2])


def test_readings_that_a_fit_takes_whole_tell_no_noise() -> None:
    """Where all readings that have a partner were such, the noise was 0 / 0."""
    free = np.concatenate([np.zeros(20), np.ones(20)])
    cell = np.concatenate([np.tile(np.arange(10), 2), 10 + np.arange(20)])
    left = np.where(free > 0, np.tile([2.0, -2.0], 20), 0.0)
    new, total, pairs = variances(left, free, cell, np.zeros(40))
    assert (new, total, pairs) == (pytest.approx(4.0), pytest.approx(4.0), 20)


def test_what_one_recording_of_a_run_has_may_change_in_it() -> None:
    """Runs of one name stood for each other: what was looked for hung on which recording was given last."""
    light = made(SWEEP, 2, machine=3)
    payload = {"load_mass_kg": np.full(len(light.runs[0]), 20.0)}
    heavy = replace(light, runs=tuple(replace(run, columns={**run.columns, **payload}) for run in light.runs))
    pairs = ({"before": heavy}, {"after": light}), ({"before": light}, {"after": heavy})
    one, other = (recorded_in_any(recordings_of(*pair), nominal()) for pair in pairs)
    assert one == other
    assert {run.payload_kg for run in one.runs} == {20.0}
    assert "load_mass_kg" in one.columns
