"""A short blind run: hidden by the simulation in time, found by the replay, with few effects to choose from."""

import numpy as np
import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.hide.campaign import hide_campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.rotation import Rotation

CHOICE = ("coulomb_level", "viscous_level", "torque_constant", "gas_loss", "current_offset")
SWEEPS = Rotation(
    experiment="rotation",
    robot="hh150",
    joint=2,
    start_deg=(0, -20, 0, 0, 90, 0),
    end_deg=70,
    speeds_deg_per_s=(10, 20),
    ramp_s=1.0,
    sample_period_s=0.04,
)


def found(hidden: dict[str, float], seed: int) -> Diagnosis:
    robot = load_robot("hh150")
    compiled, effects = compile_robot(robot), catalogue()
    acting = []
    for name, value in hidden.items():
        effect = effects[name]
        places = effect.places(compiled)
        place = places[1] if len(places) > 1 else places[0]
        acting.append(Acting(effect, place, effect.complete({effect.parameters[0].name: value})))
    data = hide_campaign(robot, SWEEPS, acting, np.random.default_rng(seed))
    return diagnose(data.campaign, compiled, {name: effects[name] for name in CHOICE})


@pytest.mark.parametrize(("name", "value"), [("coulomb_level", 0.6), ("gas_loss", 0.15)])
def test_hidden_effect_is_named_in_its_joint(name: str, value: float) -> None:
    verdict = found({name: value}, seed=3).verdict
    assert verdict.kind in ("cause", "several causes")
    named = [(cause.effect, cause.place) for e in verdict.explanations for cause in e.causes]
    assert (name, "joint 2" if name == "coulomb_level" else "robot") in named


def test_null_data_give_nothing_found() -> None:
    assert found({}, seed=4).verdict.kind == "nothing found"
