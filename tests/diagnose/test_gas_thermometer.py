"""A thermometer on the gas: with it, lost gas and cold gas are two things; without it they are one."""

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.verdict import Verdict
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.hide.campaign import hide_campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import SWEEP

CHOICE = ("coulomb_level", "gas_loss", "gas_temperature")
BINS = 60


def verdict(hidden: dict[str, dict[str, float]], channels: tuple[str, ...]) -> Verdict:
    robot, effects = load_robot("hh150"), catalogue()
    acting = [Acting(effects[name], WHOLE, effects[name].complete(values)) for name, values in hidden.items()]
    data = hide_campaign(robot, SWEEP, acting, np.random.default_rng(3), channels=channels)
    choice = {name: effects[name] for name in CHOICE}
    return diagnose(data.campaign, compile_robot(robot), choice, most_bins=BINS, proposes=False).verdict


def names(found: Verdict) -> list[set[str]]:
    return [{cause.effect for cause in explanation.causes} for explanation in found.explanations]


@pytest.mark.parametrize(
    ("name", "parameter", "size"), [("gas_loss", "lost", 0.12), ("gas_temperature", "offset", -30)]
)
def test_a_thermometer_tells_lost_gas_from_cold_gas(name: str, parameter: str, size: float) -> None:
    found = verdict({name: {parameter: size}}, ("gas_temperature",))
    assert names(found) == [{name}]
    (value,) = found.explanations[0].causes[0].parameters
    sigma = (value.high - value.low) / 2 / 1.96
    assert abs(value.value - size) < 4 * sigma
    assert sigma < 0.25 * abs(size)


def test_without_it_they_come_as_a_set() -> None:
    found = verdict({"gas_temperature": {"offset": -30}}, ())
    assert sorted(map(min, names(found))) == ["gas_loss", "gas_temperature"]


def test_a_thermometer_alone_raises_no_alarm() -> None:
    assert verdict({}, ("gas_temperature",)).kind == "nothing found"
