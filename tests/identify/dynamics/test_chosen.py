"""What is optional of a drive's friction: only with a size that it can have."""

from bench.diagnose.baseline.first_look import first_look
from bench.identify.dynamics.quantities import quantities
from tests.diagnose.sweeps import SWEEPS, made, nominal


def test_friction_that_rolls_takes_energy() -> None:
    """Beside friction that turns late it came out as -617 Nm, and Coulomb friction as 656 Nm of 577."""
    look = first_look(made(SWEEPS, 2, {"coulomb_level": 0.4}, machine=3), nominal()).found
    assert look
    found = {one.name: one for one in quantities(look)}
    adding = [one for name, one in found.items() if name.startswith(("rolling friction", "friction by the torque"))]
    assert len(adding) > 1
    assert all(one.value >= 0 for one in adding)
    level = found["Coulomb friction (joint2)"]
    assert abs(level.value - 1.4 * 412) < 1.645 * level.sigma
