"""Where nothing plausible explains a campaign, causes are looked for that are several times as large."""

import pytest

from bench.diagnose import explain
from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.extend.fit import BEYOND
from bench.diagnose.linearise.candidates import LARGER
from bench.effects.catalogue import catalogue
from tests.diagnose.sweeps import SWEEPS, made, nominal

LISTED = ("coulomb_level", "gas_loss", "gas_temperature", "payload_mass", "viscous_level", "torque_offset")


def diagnosed(seed: int, hidden: dict[str, float]) -> Diagnosis:
    effects = {name: catalogue()[name] for name in LISTED}
    return diagnose(made(SWEEPS, seed, hidden=hidden), nominal(), effects, proposes=False)


@pytest.mark.parametrize(("name", "value", "place"), [("coulomb_level", 2.0, "joint 2"), ("gas_loss", 0.7, "robot")])
def test_what_is_larger_than_plausible_is_named_and_doubted(name: str, value: float, place: str) -> None:
    """Friction three times as large was 'friction of the link side' at > 99.9 %; of 70 % less gas nothing was found."""
    (parameter, *_) = catalogue()[name].parameters
    assert parameter.high * BEYOND < value < parameter.high * BEYOND * LARGER
    verdict = diagnosed(31, {name: value}).verdict
    (cause,) = verdict.explanations[0].causes
    assert cause.name == (name, place)
    (found, *_) = cause.parameters
    assert found.low < value < found.high
    share = found.value / parameter.high
    assert f"{share:.2g} times the largest plausible size" in cause.advice


def test_what_is_plausible_is_named_without_a_doubt() -> None:
    (cause,) = diagnosed(32, {"coulomb_level": 0.5}).verdict.explanations[0].causes
    assert cause.name == ("coulomb_level", "joint 2")
    assert not cause.advice


def test_nothing_is_looked_for_again_where_nothing_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    effects = {name: catalogue()[name] for name in LISTED}
    diagnose(made(SWEEPS, 33, hidden={}), nominal(), effects, progress=said.append, proposes=False)
    assert said
    assert not [words for words in said if "once more" in words]


@pytest.mark.parametrize("is_tried", [True, False])
def test_what_is_not_listed_stays_unlisted(is_tried: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cause that is four times as large as plausible may imitate anything a little; it was looked for, too.

    Where it explains little of that in the linearised model, nothing is fitted again.
    """
    if is_tried:
        monkeypatch.setattr(explain, "may_be_larger", lambda naming: True)
    said: list[str] = []
    effects = {name: catalogue()[name] for name in ("gas_loss", "payload_mass", "coulomb_level")}
    campaign = made(SWEEPS, 34, hidden={"friction_ripple": 0.3})
    verdict = diagnose(campaign, nominal(), effects, progress=said.append, proposes=False).verdict
    assert bool([words for words in said if "once more" in words]) == is_tried
    assert verdict.kind == "unlisted cause"
    assert verdict.unlisted
    assert verdict.unlisted.place == "joint 2"


def test_a_play_is_looked_for_again_where_a_fit_wanted_it_larger() -> None:
    """Where a link rests within its play is chance, so signatures show little of it, however large it may be."""
    (parameter,) = catalogue()["backlash"].parameters
    gap = 2.5 * parameter.high
    effects = {name: catalogue()[name] for name in (*LISTED, "backlash", "joint_compliance", "softening")}
    verdict = diagnose(made(SWEEPS, 31, hidden={"backlash": gap}), nominal(), effects, proposes=False).verdict
    (cause,) = verdict.explanations[0].causes
    assert cause.name == ("backlash", "joint 2")
    assert "times the largest plausible size" in cause.advice
