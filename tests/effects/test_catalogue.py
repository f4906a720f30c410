"""The catalogue as a whole, entries from own files, and what is said of bad ones."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from bench.cli import main
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect, Place
from bench.effects.listing import entry, listing
from bench.effects.own import EffectError
from bench.effects.unlisted import unlisted
from bench.errors import InputError
from bench.robot.compiled import CompiledRobot

OF_DESIGN = [
    "polytropic_exponent",
    "gas_loss",
    "gas_temperature",
    "thermal_relaxation",
    "seal_friction",
    "anchor",
    "coulomb_level",
    "viscous_level",
    "stribeck",
    "load_friction",
    "direction_friction",
    "friction_temperature",
    "friction_side",
    "friction_ripple",
    "softening",
    "backlash",
    "hysteresis",
    "transmission_error",
    "wrist_coupling",
    "link_bending",
    "bearing_tilt",
    "base_compliance",
    "payload_mass",
    "payload_com",
    "link_mass",
    "link_com",
    "joint_zero",
    "link_length",
    "dress_pack",
    "thermal_growth",
    "torque_constant",
    "torque_saturation",
    "torque_constant_temperature",
    "current_offset",
    "tracker_frame",
    "tracker_drift",
    "force_gain",
    "force_tilt",
    "encoder_delay",
    "encoder_eccentricity",
]
OWN = """
from bench.effects.effect import Effect, Parameter

class Gremlin(Effect):
    name = "gremlin"
    family = "own"
    title = "gremlin"
    physics = "It is in there."
    source = "seen"
    parameters = (Parameter("size", "m", 0.0, 0.1, 1.0, "how big"),)

    def edit(self, place, values, conditions):
        return None
"""


def test_every_effect_that_was_asked_for() -> None:
    names = list(catalogue())
    assert [name for name in names if name in OF_DESIGN] == OF_DESIGN, "all of them, in the order of the table"


def test_unlisted_effects_are_not_in_the_catalogue() -> None:
    assert len(unlisted()) >= 5
    assert not set(unlisted()) & set(catalogue())


def test_own_file(tmp_path: Path) -> None:
    file = tmp_path / "own.py"
    file.write_text(OWN)
    effects = catalogue([file])
    assert list(effects)[-1] == "gremlin"
    assert effects["gremlin"].complete({}) == {"size": 0.0}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "no such file"),
        ("import nothing_of_that_name", "does not run: ModuleNotFoundError"),
        ("class", "does not run: SyntaxError"),
        ("x = 1", "defines no effect"),
        (OWN.replace('"gremlin"', '"gas_loss"', 1), "'gas_loss' already"),
        (OWN.replace('    source = "seen"\n', "").replace('    title = "gremlin"\n', ""), "set title, source"),
        (OWN.replace('(Parameter("size", "m", 0.0, 0.1, 1.0, "how big"),)', "()"), "parameters is empty"),
    ],
)
def test_bad_files(tmp_path: Path, text: str | None, said: str) -> None:
    file = tmp_path / "bad.py"
    if text is not None:
        file.write_text(text)
    with pytest.raises(InputError, match=said) as error:
        catalogue([file])
    assert str(file) in str(error.value)


def test_listing_names_everything(hh150_compiled: CompiledRobot) -> None:
    text = listing(catalogue(), hh150_compiled)
    for name, effect in catalogue().items():
        assert name in text
        assert effect.family.upper() in text
        whole = entry(effect, hh150_compiled)
        assert all(parameter.name in whole for parameter in effect.parameters)
        assert ("first pass" in whole) == effect.only_if_told


def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["effects"]) == 0
    assert "seal_friction" in capsys.readouterr().out
    assert main(["effects", "backlash"]) == 0
    assert "Nordin" in capsys.readouterr().out
    assert main(["effects", "backlas"]) == InputError.exit_code
    assert "Did you mean 'backlash'?" in capsys.readouterr().err
    file = tmp_path / "own.py"
    file.write_text(OWN)
    assert main(["effects", "gremlin", "--file", str(file)]) == 0
    assert "It is in there" in capsys.readouterr().out


def test_another_edit_has_other_torques(tmp_path: Path, hh150_compiled: CompiledRobot) -> None:
    """Friction that a user makes of an entry of the catalogue is not first-order of what that entry does."""
    file = tmp_path / "own.py"
    file.write_text(
        "from bench.effects.lubricant import ViscousFriction\n"
        "class Sticky(ViscousFriction):\n"
        "    name = 'sticky'\n"
        "    def edit(self, place, values, conditions):\n"
        "        return None\n"
    )
    effect = catalogue([file])["sticky"]
    assert type(effect).torques is Effect.torques
    assert not effect.is_additive
    assert type(catalogue()["viscous_friction"]).torques is not Effect.torques


@pytest.mark.parametrize(
    ("returned", "said"),
    [("1.0", "must return Torques"), ("Torques(motor=float('nan'))", "finite"), ("Torques(link=[1.0])", "instants")],
)
def test_wrong_torques_of_an_own_effect_are_named(
    returned: str, said: str, tmp_path: Path, hh150_compiled: CompiledRobot
) -> None:
    file = tmp_path / "own.py"
    file.write_text(
        "from bench.effects.followed import Torques\n"
        "from bench.effects.lubricant import ViscousFriction\n"
        "class Sticky(ViscousFriction):\n"
        "    name = 'sticky'\n"
        "    def edit(self, place, values, conditions):\n"
        "        return None\n"
        "    def torques(self, place, values, followed):\n"
        f"        return {returned}\n"
    )
    effect = catalogue([file])["sticky"]
    followed = SimpleNamespace(trace=range(3))
    with pytest.raises(EffectError, match=said):
        effect.torques(Place("joint"), {}, followed)  # type: ignore[arg-type]
