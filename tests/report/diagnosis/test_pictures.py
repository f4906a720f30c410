"""Which channels and which angle are drawn."""

import numpy as np
import pytest

from bench.diagnose.replay.quantities import Quantity
from bench.report.diagnosis.pictures import pictures_of, telling_joint
from bench.report.diagnosis.readings import Readings

T = 200  # instants; each has a reading of both channels


@pytest.fixture
def readings(rng: np.random.Generator) -> Readings:
    """Two joints that move; the force depends on the angle of the second, the current on nothing."""
    angle = rng.uniform(-1, 1, (T, 2))
    wrong = np.stack([rng.normal(size=T), 5 * np.sin(3 * angle[:, 1])], axis=1).ravel()
    return Readings(
        quantities=(Quantity("current_1_a", "current", "A", 0), Quantity("force_x_n", "force", "N")),
        before=wrong,
        after=np.zeros(2 * T),
        measured=np.zeros((T, 2)),
        simulated=np.zeros((T, 2)),
        extended=None,
        instant=np.repeat(np.arange(T), 2),
        column=np.tile([0, 1], T),
        run=np.zeros(T, dtype=np.int64),
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
