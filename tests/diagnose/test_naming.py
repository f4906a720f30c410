"""A short blind run: hidden by the simulation in time, found by the replay, with few effects to choose from."""

import pytest

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.effects.catalogue import catalogue
from tests.diagnose.sweeps import SWEEPS, made, nominal

CHOICE = ("coulomb_level", "viscous_level", "torque_constant", "gas_loss", "current_offset")


def found(hidden: dict[str, float], seed: int) -> Diagnosis:
    effects = catalogue()
    return diagnose(made(SWEEPS, seed, hidden), nominal(), {name: effects[name] for name in CHOICE})


@pytest.mark.parametrize(("name", "value"), [("coulomb_level", 0.6), ("gas_loss", 0.15)])
def test_hidden_effect_is_named_in_its_joint(name: str, value: float) -> None:
    verdict = found({name: value}, seed=3).verdict
    assert verdict.kind in ("cause", "several causes")
    named = [(cause.effect, cause.place) for e in verdict.explanations for cause in e.causes]
    assert (name, "joint 2" if name == "coulomb_level" else "robot") in named


def test_null_data_give_nothing_found() -> None:
    assert found({}, seed=4).verdict.kind == "nothing found"
