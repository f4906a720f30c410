"""Where all friction of a drive grew and one kind of it is named, its interval holds by how much that one grew."""

import numpy as np
import pytest

from bench.compare.background import Background
from bench.compare.comparison import NORMAL_90
from bench.compare.moved_along import averaged, moved_along
from bench.compare.profiles import profiles_of
from bench.compare.search_changes import Found, find_changes, sizes_of
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.screening import Entry
from bench.effects.catalogue import catalogue
from bench.effects.effect import Place
from bench.record.campaign import Array
from tests.compare.once import seen_once
from tests.diagnose.sweeps import nominal

READINGS = 60
RATE = 0.01
LOADS = np.linspace(0.8, 1.2, READINGS)  # of the joint, against their mean
COULOMB = 10.0  # [standard errors], of each reading
LOAD = 200.0  # [standard errors], that friction of a coefficient of one adds under the mean load
SHARE, COEFFICIENT = 0.2, 0.02  # by which all friction grew, and the coefficient that was there before
DRAWN = 200_000
NAMES = ("coulomb_level", "load_friction", "torque_offset")


def entry_of(name: str, place: Place, column: Array, at: int) -> Entry:
    """Return a cause with one size, in its unit, as large as is plausible for it."""
    effect = catalogue()[name]
    (size,) = (one for one in effect.parameters_at(nominal(), place) if not one.is_shape)
    prior = np.array([size.high / np.sqrt(3)])
    candidate = Candidate(Cause(effect, place, (size,), ()), {}, np.ones(1), prior, column[:, None])
    return Entry(candidate, np.array([at]), ((prior, 0.0),))


def found_of(names: tuple[str, ...], *, elsewhere: bool = False) -> tuple[Background, Found]:
    """Return what is said of a drive of which Coulomb and load friction both grew by a fifth."""
    places = catalogue()["coulomb_level"].places(nominal())
    shown = {
        "coulomb_level": np.full(READINGS, COULOMB),
        "load_friction": LOAD * LOADS,
        "torque_offset": np.cos(np.arange(READINGS)) / 100,
    }
    change = SHARE * (shown["coulomb_level"] + COEFFICIENT * shown["load_friction"])
    entries = tuple(
        entry_of(name, places[1 + (elsewhere and name == "load_friction")], shown[name], i)
        for i, name in enumerate(names)
    )
    columns = np.stack([shown[name] for name in names], axis=1)
    background = seen_once(entries, columns, change, nominal())
    return background, find_changes(background, profiles_of(1, np.array([np.nan, np.nan])), RATE)


def test_the_interval_of_coulomb_friction_holds_where_load_friction_grew_as_well() -> None:
    """It came out as +28 % (26 to 30) of 20: what the load adds looked like more of it."""
    background, found = found_of(NAMES)
    terms = found.alternatives[0].best.terms
    assert [found.possible[i].key[0] for i in terms] == ["coulomb_level"]  # type: ignore[index]
    (alone,), (sigma,) = sizes_of(found, terms)
    assert alone - NORMAL_90 * sigma > SHARE, "else the test says nothing"
    along = moved_along(background, found, terms)
    assert [[one.effect.name for one in causes] for causes in along.causes] == [["load_friction"]]
    assert abs(along.mean[0] - SHARE) < NORMAL_90 * along.sigma[0]
    assert along.mean[0] > NORMAL_90 * along.sigma[0], "that it grew is as sure"
    assert abs(along.mean[0] - alone) < NORMAL_90 * along.sigma[0], "it may have grown alone as well"


def test_what_moves_along_is_as_large_a_share_of_what_is_plausible() -> None:
    background, found = found_of(NAMES)
    terms = found.alternatives[0].best.terms
    (alone,), _ = sizes_of(found, terms)
    (prior,) = moved_along(background, found, terms).prior
    assert prior == pytest.approx(alone * background.entries[1].priors[0][0][0])


@pytest.mark.parametrize(("names", "elsewhere"), [(NAMES, True), (("coulomb_level", "torque_offset"), False)])
def test_nothing_moves_along_at_another_drive_or_of_another_kind(names: tuple[str, ...], elsewhere: bool) -> None:
    background, found = found_of(names, elsewhere=elsewhere)
    terms = found.alternatives[0].best.terms
    along = moved_along(background, found, terms)
    assert not len(along.prior)
    for one, other in zip((along.mean, along.sigma), sizes_of(found, terms), strict=True):
        np.testing.assert_array_equal(one, other)


def test_sizes_are_averaged_as_of_two_machines(rng: np.random.Generator) -> None:
    is_second = rng.random(DRAWN) < 0.3
    drawn = np.where(is_second, rng.normal(2.0, 0.5, DRAWN), rng.normal(1.0, 0.2, DRAWN))
    mean, sigma = averaged((np.array([1.0]), np.array([2.0])), (np.array([0.2]), np.array([0.5])), 0.3)
    assert mean[0] == pytest.approx(np.mean(drawn), rel=0.01)
    assert sigma[0] == pytest.approx(np.std(drawn), rel=0.01)


def test_all_friction_that_moves_with_another_kind_is_in_the_catalogue() -> None:
    known = catalogue()
    for effect in known.values():
        assert set(effect.moves_with) <= known.keys()
        if effect.moves_with:
            first = effect.parameters[0]
            assert first.signed
            assert not first.unit, "a share of a level"
