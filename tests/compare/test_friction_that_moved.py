"""Friction that moved from a link to its motor has the size that it has, as much as friction that moved there."""

import pytest

from bench.compare.compare import compare
from bench.compare.recordings import recordings_of
from bench.effects.catalogue import catalogue
from tests.diagnose.sweeps import LOADS, made, nominal


@pytest.mark.parametrize(("moved", "machine"), [(-0.2, 0), (0.2, 1), (-0.25, 4)])
def test_the_size_of_friction_that_moved_is_in_its_interval_either_way(moved: float, machine: int) -> None:
    """Its signature is that of friction that moves to the link: -0.20 came out as -0.09 (-0.11 to -0.08)."""
    known = {name: catalogue()[name] for name in ("friction_side", "coulomb_level", "gas_loss", "torque_constant")}
    before, after = (made(LOADS, 100 + 2 * machine + k, {"friction_side": k * moved}, machine=machine) for k in (0, 1))
    (change,) = compare(recordings_of({"may": before}, {"june": after}), nominal(), known).explanations[0].changes
    assert (change.effect, change.place) == ("friction_side", "joint 2")
    size = change.sizes[0].change
    print(f"{moved:g} came out as {size.value:.3f} ({size.low:.3f} to {size.high:.3f})")
    assert size.low < moved < size.high
