"""Every assumed number matters: what it is there for fails with half of it, and with twice as much."""

import pytest

from bench.study.constants import constants_of, set_to
from tests.diagnose.assumed import effects, first_pass, motion, plausibility, priors, scatter, weighing
from tests.diagnose.assumed.registry import CHECKS

MODULES = (effects, first_pass, motion, plausibility, priors, scatter, weighing)  # they register what they check
CONSTANTS = {constant.words: constant for constant in constants_of()}
FACTORS = (0.5, 2.0)


@pytest.mark.parametrize("words", CHECKS)
def test_it_does_what_it_is_there_for(words: str) -> None:
    CHECKS[words]()


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("words", CHECKS)
def test_a_factor_of_two_breaks_it(words: str, factor: float) -> None:
    constant = CONSTANTS[words]
    with set_to(constant, constant.times(factor)), pytest.raises(AssertionError):
        CHECKS[words]()
