"""A drive that stands while others move is not blamed for where their payload hangs."""

import numpy as np

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.mistaken import mistakes_in

SLACK = 8.0  # [Nm]
CARRIED = 3.0  # [kg]


TIME = np.linspace(0.0, 6.0, 200)
PUSHED = 10.0 * np.cos(TIME)
# drive 1 moves; drive 2 stands and reads -5 Nm: what drive 1 carries would make it hold 150 Nm, so far out as its place
# is presumed here
PICTURE = DrivePicture(
    observed=np.stack([CARRIED * PUSHED, np.full(200, -5.0)], axis=1),
    model=np.zeros((200, 2)),
    velocity=np.stack([np.sin(TIME), np.zeros(200)], axis=1),
    standing=np.stack([np.zeros(200, dtype=bool), np.ones(200, dtype=bool)], axis=1),
    slack=np.full(2, SLACK),
    level=np.zeros(2),
    spare=np.zeros((2, 2)),
    unit=np.ones(2),
    missing=np.stack([PUSHED, np.full(200, 50.0)], axis=1)[:, :, None],
    names=("current_1_a", "current_2_a"),
)


def test_a_drive_that_stands_is_not_told_by_those_that_move() -> None:
    """A gantry whose first axis moved alone: "A and B are exchanged", of two hinges that stood."""
    assert not list(mistakes_in(PICTURE))
