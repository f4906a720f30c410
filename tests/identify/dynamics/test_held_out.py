"""When one model surely predicts better than another what was held out of both."""

import numpy as np
import pytest

from bench.identify.dynamics.held_out import MUCH, Missed, surely_positive

READINGS = np.full((2, 3), 1000.0)


def missed(*rms: float, second: tuple[float, ...] = ()) -> Missed:
    """Return what three drives miss in two folds [Nm]."""
    squares = READINGS * np.array([rms, second or rms]) ** 2
    return Missed(squares, squares, READINGS)


@pytest.mark.parametrize(
    ("new", "is_better"),
    [
        (missed(0.5, 0.5, 0.5), True),
        (missed(0.5, 0.5, 1.03, second=(0.52, 0.5, 1.0)), True),  # the third is worse in one of two folds alone
        (missed(0.5, 0.5, 1.05, second=(0.52, 0.5, 1.05)), False),  # in both of them
        (missed(0.5, 0.5, 1.4, second=(0.52, 0.5, 0.95)), False),  # by more than a tenth in all
        (missed(0.5, 0.5, 1.0, second=(1.9, 1.9, 1.0)), False),  # folds differ by more than what is gained
    ],
)
def test_a_drive_that_chance_makes_worse_does_not_forbid_what_all_others_ask_for(new: Missed, is_better: bool) -> None:
    """A delay of 3 ms with winding gears left 0.4 to 0.9 of six drives, and 1.03 of the seventh: it was left out.

    On an arm of another laboratory, of whose intervals 65 of 84 held the truth then, and 73 do now.
    """
    assert new.surely_less_than(missed(1.0, 1.0, 1.0)) is is_better
    assert MUCH**2 * 2 < 1.4**2 + 0.95**2


@pytest.mark.parametrize(
    ("gain", "is_sure"),
    [
        ([16.0, 26.0, 40.0, 94.0, 505.0], True),  # each run asks for a delay, and the one that moves both slides most
        ([1.0, -1.0, 2.0, -2.0, 505.0], False),  # one run alone
        ([50.0, 50.0, 50.0, 50.0, -195.0], False),
    ],
)
def test_a_run_that_tells_much_more_does_not_make_the_others_unsure(gain: list[float], is_sure: bool) -> None:
    """On a stranger's gantry a delay that left a third of an axis was refused, and its friction came out a third off.

    Of whose viscous friction 35 +- 4 N s/m was found beside 21 of rolling friction; 52 is right, and none rolls.
    """
    assert surely_positive(np.array(gain)[:, None])[0] == is_sure
