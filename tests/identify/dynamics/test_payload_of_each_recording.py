"""What a machine carries is another thing in each recording, unless the data say that it is the same."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.folds import blocks_of
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.quantities import quantities
from bench.record.campaign import Campaign
from bench.robot.nominal_dynamics import NominalDynamics
from bench.robot.payload import with_payload
from tests.identify.dynamics.rigid_world import Friction, arm, drawn, recorded, robot

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.array([0.5, -1.0, 0.8]))
UNCERTAIN = {"mass": 0.02, "centre_of_mass_m": 0.005}
NOISE = 2.0  # [Nm]
LIGHT, HEAVY = 3.0, 11.0  # [kg]


def nominal_arm() -> NominalDynamics:
    return robot(arm(), payload=20.0, **UNCERTAIN)


def days(loads: dict[str, float], runs: int, seed: int = 3) -> Campaign:
    """Return recordings of one true arm that carries another weight each day."""
    rng = np.random.default_rng(seed)
    true = drawn(nominal_arm(), rng)
    found = []
    for day, (name, mass) in enumerate(loads.items()):
        loaded = replace(true, bodies=with_payload(true.bodies, mass, "hook"))
        for run in recorded(loaded, FRICTION, rng, runs, NOISE).runs:
            start = 1000.0 * day + run.start_s
            found.append(replace(run, name=f"{name}.{run.name}", recording=name, start_s=start))
    return Campaign("rigid", tuple(found))


def payloads(found: FirstPass) -> dict[str, tuple[float, float]]:
    """Return the intervals of all payloads by name."""
    named = {one.name: one for one in quantities(found) if one.kind == "payload"}
    return {name: one.interval(found.quantile()) for name, one in named.items() if "payload" in name}


@pytest.mark.parametrize("runs", [1, 3], ids=["one run a day", "three runs a day"])
def test_each_day_has_its_own_payload(runs: int) -> None:
    """One for all left eleven kilograms less three in friction, masses and what was held out."""
    found = first_pass(days({"may": LIGHT, "june": HEAVY}, runs), nominal_arm(), find_delay=False)
    told = payloads(found)
    assert list(told) == ["unstated payload (may)", "unstated payload (june)"]
    for (low, high), mass in zip(told.values(), (LIGHT, HEAVY), strict=True):
        assert low < mass < high
    alike = first_pass(days({"may": LIGHT, "june": LIGHT}, runs), nominal_arm(), find_delay=False)
    for model in ("first_pass", "rival"):
        assert np.all(found.held_out.rms(model) < 1.2 * alike.held_out.rms(model))


def test_one_payload_stays_one() -> None:
    found = first_pass(days({"may": LIGHT, "june": LIGHT}, 2), nominal_arm(), find_delay=False)
    ((low, high),) = payloads(found).values()
    assert low < LIGHT < high


def test_another_day_carries_what_the_last_one_did() -> None:
    found = first_pass(days({"may": LIGHT, "june": HEAVY}, 2), nominal_arm(), find_delay=False)
    july = days({"july": HEAVY}, 1)
    np.testing.assert_array_less(found.predict(july).rms("first_pass"), 1.2 * NOISE)
    assert np.max(found.predict(days({"july": LIGHT}, 1)).rms("first_pass")) > 3 * NOISE


def test_a_block_of_each_run_is_held_out() -> None:
    found = first_pass(days({"may": LIGHT, "june": LIGHT}, 1), nominal_arm(), find_delay=False)
    folds = blocks_of(found.stretches)
    for of, near in zip(folds.of, folds.near, strict=True):
        assert set(of.tolist()) == set(range(len(folds)))
        assert np.all(np.diff(of) >= 0)
        assert not np.any(near[np.arange(len(of)), of])
