"""Which channels and which angle are drawn."""

import re
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.name.learned_shape import LearnedCurve
from bench.diagnose.replay.quantities import Quantity
from bench.report.diagnosis.pictures import Picture, learned_picture, pictures_of, telling_joint
from bench.report.diagnosis.readings import Readings

T = 200  # instants; each has a reading of both channels


@pytest.fixture
def readings(rng: np.random.Generator) -> Readings:
    """Two joints that move; the force depends on the angle of the second, the current on nothing."""
    angle = rng.uniform(-1, 1, (T, 2))
    wrong = np.stack([rng.normal(size=T), 5 * np.sin(3 * angle[:, 1])], axis=1).ravel()
    return Readings(
        quantities=(Quantity("current_1_a", "current", "A", 0), Quantity("force_x_n", "force", "N")),
        nominal=wrong.reshape(T, 2),
        left=np.zeros((T, 2)),
        noise=np.ones((T, 2)),
        before=wrong,
        after=np.zeros(2 * T),
        measured=np.zeros((T, 2)),
        simulated=np.zeros((T, 2)),
        extended=None,
        instant=np.repeat(np.arange(T), 2),
        column=np.tile([0, 1], T),
        run=np.zeros(T, dtype=np.int64),
        seconds=np.arange(T, dtype=np.float64),
        is_slide=np.zeros(2, dtype=bool),
        angle=angle,
        direction=np.ones((T, 2)),
    )


def test_the_angle_that_tells_most_is_drawn(readings: Readings) -> None:
    assert telling_joint(readings, 1) == 1


def test_one_stray_reading_tells_nothing(readings: Readings) -> None:
    readings.before[3] = 1e4
    assert telling_joint(readings, 1) == 1


def test_at_rest_there_is_no_angle_to_draw_over(readings: Readings) -> None:
    readings.direction[:] = 0.0
    assert telling_joint(readings, 1) is None


def test_only_channels_that_stand_out_are_drawn(readings: Readings) -> None:
    ((name, pictures),) = pictures_of(readings)
    assert name == "force x"
    assert len(pictures) == 2
    assert "joint 2" in pictures[0].words


def test_residuals_are_drawn_in_the_unit_of_the_channel_over_time_and_angle(readings: Readings) -> None:
    left = replace(readings, left=np.where(np.arange(2) == 1, 0.25, 0.0) * np.ones((T, 2)))
    ((_, (over_angle, over_time)),) = pictures_of(left)
    nominal = np.sqrt(np.mean(left.nominal[:, 1] ** 2))
    for words in (
        "[N]",
        f"nominal model: RMS {nominal:.2f} N",
        "with what was found: RMS 0.250 N",
    ):
        assert words in text_of(over_angle), words
        assert words in text_of(over_time), words
    assert "angle of joint 2 [deg]" in text_of(over_angle)
    assert "time [s]" in text_of(over_time)


def test_where_nothing_was_found_the_figures_are_fitted(readings: Readings) -> None:
    ((_, (over_angle, _)),) = pictures_of(replace(readings, after=None))
    assert "with its figures fitted: RMS" in text_of(over_angle)


def test_a_slide_has_a_position(readings: Readings) -> None:
    ((_, (over_position, _)),) = pictures_of(replace(readings, is_slide=np.ones(2, dtype=bool)))
    assert "position of joint 2 [mm]" in text_of(over_position)
    assert "position of joint 2" in over_position.words


def test_a_learned_force_over_the_position_of_a_slide_is_called_so() -> None:
    curve = LearnedCurve("", "angle", "m", "N", (0.0, 0.1, 0.2), (1.0, 2.0, 3.0), (0.0, 1.0, 2.0), (2.0, 3.0, 4.0))
    drawn = learned_picture(curve, "link torque")
    assert "link force [N]" in text_of(drawn)
    assert "position [mm]" in text_of(drawn)
    assert drawn.words.startswith("link force as learned over position")


def text_of(picture: Picture) -> str:
    """Return what is written in a picture; Matplotlib draws letters as paths and leaves the text as comments."""
    return " ".join(re.findall("<!-- (.*?) -->", picture.svg))
