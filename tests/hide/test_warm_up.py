"""The warm-up model against its closed form."""

import numpy as np
import pytest

from bench.hide.warm_up import GEAR_TIME_S, WINDING_TIME_S, Spell, WarmUp


def test_work_warms_towards_the_rise_and_rest_cools() -> None:
    day = WarmUp(np.array([12.0]), np.array([25.0]), 0.0)
    hour = 3600.0
    spells = [Spell(hour, works=True)] * 5 + [Spell(hour, works=False)] * 5
    conditions = day.over(spells)
    for i in range(5):
        middle = (i + 0.5) * hour
        assert conditions[i].gear_k[0] - 293.15 == pytest.approx(12 * (1 - np.exp(-middle / GEAR_TIME_S)))
        assert conditions[i].winding_k[0] - 293.15 == pytest.approx(25 * (1 - np.exp(-middle / WINDING_TIME_S)))
    end = 12 * (1 - np.exp(-5 * hour / GEAR_TIME_S))
    assert conditions[5].gear_k[0] - 293.15 == pytest.approx(end * np.exp(-0.5 * hour / GEAR_TIME_S))


def test_gas_follows_the_air() -> None:
    day = WarmUp(np.zeros(1), np.zeros(1), 1.0)
    conditions = day.over([Spell(600.0, works=False)] * 60)
    gas, air = (np.array([getattr(one, name) for one in conditions]) for name in ("gas_k", "ambient_k"))
    assert np.all(np.diff(air) > 0)
    assert np.all(gas < air)
    assert air[-1] - 293.15 == pytest.approx(1.0, abs=0.01)
    assert gas[-1] - 293.15 == pytest.approx(1.0, abs=0.05)


def test_drives_differ_a_little(rng: np.random.Generator) -> None:
    day = WarmUp.draw(6, rng)
    assert np.all(np.abs(day.gear_rise / 12 - 1) <= 0.2)
    assert len(set(day.winding_rise.tolist())) == 6
