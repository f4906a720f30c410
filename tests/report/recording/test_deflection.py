"""Deflection against the unloaded state of the same pose."""

from dataclasses import replace

import numpy as np

from bench.report.recording.deflection import deflection_of
from bench.robot.compiled import CompiledRobot
from bench.simulate.session import Film
from tests.report.films import MOVE, PART, instants, made_film, without

ROUNDING = 1e-15  # [m], of differences of positions of the order of 1 m


def test_is_what_the_load_moves(film: Film) -> None:
    true = film.trace.reflectors[:, 0]
    deflection = deflection_of(film)
    assert np.all(np.isnan(deflection.true[:MOVE]))
    np.testing.assert_allclose(deflection.true[MOVE:], true[MOVE:] - true[MOVE], rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(deflection.measured, deflection.true, rtol=0, atol=ROUNDING)  # perfect instruments
    assert np.linalg.norm(deflection.true[MOVE + 2 * PART]) > 1e-3


def test_what_is_wrong_with_the_frame_cancels(film: Film) -> None:
    shifted = replace(film.reading, reflectors=film.reading.reflectors + np.array([1e-3, -2e-3, 3e-3]))
    np.testing.assert_allclose(
        deflection_of(replace(film, reading=shifted)).measured, deflection_of(film).measured, atol=1e-14
    )


def test_ringing_after_a_move_is_not_the_reference(film: Film) -> None:
    ringing = film.trace.reflectors.copy()
    ringing[MOVE : MOVE + 3] += 0.01
    film_that_rings = replace(film, trace=replace(film.trace, reflectors=ringing))
    np.testing.assert_array_equal(
        deflection_of(film_that_rings).true[MOVE + PART :], deflection_of(film).true[MOVE + PART :]
    )


def test_a_stand_that_begins_loaded_refers_to_its_unloaded_end(film: Film) -> None:
    true = deflection_of(instants(film, slice(MOVE + PART, None))).true
    np.testing.assert_allclose(true[-PART:], 0, atol=ROUNDING)


def test_never_unloaded_or_without_tracker_is_nan(film: Film) -> None:
    loaded = instants(film, slice(MOVE + PART, MOVE + 3 * PART))
    assert np.all(np.isnan(deflection_of(loaded).true))
    blind = deflection_of(without(film, "reflectors"))
    assert np.all(np.isnan(blind.measured))
    assert not np.all(np.isnan(blind.true))


def test_never_loaded_is_noise_around_zero(compiled: CompiledRobot, rng: np.random.Generator) -> None:
    film = instants(made_film(compiled, rng), slice(MOVE, MOVE + PART))
    deflection = deflection_of(film)
    np.testing.assert_allclose(deflection.true, 0, atol=ROUNDING)
    assert 0 < np.std(deflection.measured) < 1e-4
