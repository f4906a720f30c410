"""A fault in the attributes ends the compilation with a message that says which, where, and what is allowed."""

import ctypes
from dataclasses import fields
from pathlib import Path

import mujoco
import pytest

from bench.actuators.laws import Friction, GasSpring, TorqueTable
from tests.actuators.slider import NAMES, Law, attributes, element, mjcf

GAS = GasSpring(constant=4771.4, critical_length=0.9112)
FRICTION = Friction(coulomb=100, presliding_stiffness=1e6)
TABLE = TorqueTable(angle_min=0, angle_max=1, forward=(1, 2), backward=(2, 3), presliding_stiffness=1e5)


@pytest.fixture(autouse=True)
def log_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings to MUJOCO_LOG.TXT


def refusal(text: str) -> str:
    with pytest.raises(ValueError, match=r"bench\.") as caught:
        mujoco.MjModel.from_xml_string(text)
    return str(caught.value)


NOT_NUMBERS = ["1x", "one", "1,5", "nan", "inf", "-inf", "1e999", "1 2", "--1", "."]


@pytest.mark.parametrize("value", NOT_NUMBERS)
@pytest.mark.parametrize(
    ("law", "name"),
    [(GAS, "constant"), (FRICTION, "ripple_phase"), (TABLE, "angle_min")],
    ids=["gas", "friction", "table"],
)
def test_not_a_number(law: Law, name: str, value: str):
    message = refusal(mjcf(element(law, "culprit", **{name: value})))
    assert f"{NAMES[type(law)]}, actuator 0 'culprit': attribute {name} = '{value}' must be " in message


@pytest.mark.parametrize(
    ("law", "name", "value", "rule"),
    [
        (GAS, "constant", "0", "must be a finite number > 0"),
        (GAS, "critical_length", "-1", "must be a finite number > 0"),
        (GAS, "exponent", "0", "must be a finite number > 0"),
        (GAS, "reference_length", "-0.1", "must be a finite number >= 0"),
        (GAS, "reference_length", "0.9112", "must be below critical_length"),
        (GAS, "gas_amount", "-0.1", "must be a finite number >= 0"),
        (GAS, "heat_capacity_ratio", "0.9", "must be a finite number >= 1"),
        (GAS, "relaxation_time", "0", "must be a finite number > 0"),
        (GAS, "seal_friction", "1", "must be a number from 0 to below 1"),
        (GAS, "seal_presliding", "0", "must be a finite number > 0"),
        (FRICTION, "coulomb", "-1e-9", "must be a finite number >= 0"),
        (FRICTION, "presliding_stiffness", "0", "must be a finite number > 0"),
        (FRICTION, "static_rise", "-0.1", "must be a finite number >= 0"),
        (FRICTION, "stribeck_velocity", "0", "must be a finite number > 0"),
        (FRICTION, "asymmetry", "1", "must be a number between -1 and 1, both excluded"),
        (FRICTION, "asymmetry", "-1", "must be a number between -1 and 1, both excluded"),
        (FRICTION, "load_coefficient", "-0.1", "must be a finite number >= 0"),
        (FRICTION, "ripple", "1", "must be a number from 0 to below 1"),
        (FRICTION, "ripple_period", "0", "must be a finite number > 0"),
        (FRICTION, "element", "gears", "must be the name of a tendon"),
        (FRICTION, "element", "gear rod", "must be the name of a tendon"),
        (TABLE, "angle_max", "0", "must be above angle_min"),
        (TABLE, "presliding_stiffness", "-1", "must be a finite number > 0"),
        (TABLE, "forward", "1", "must have two numbers or more"),
        (TABLE, "forward", "1 2x", "must be finite numbers separated by blanks"),
        (TABLE, "backward", "2 3 4", "must have as many numbers as forward"),
        (TABLE, "backward", "2 1.9", "must nowhere be below forward"),
    ],
)
def test_out_of_range(law: Law, name: str, value: str, rule: str):
    message = refusal(mjcf(element(law, "culprit", **{name: value})))
    assert f"{NAMES[type(law)]}, actuator 0 'culprit': attribute {name} = '{value}' {rule}" in message


@pytest.mark.parametrize(
    ("law", "given", "missing", "reason"),
    [
        (GAS, {"exponent": "1.2"}, "reference_length", "exponent other than 1"),
        (GAS, {"heat_capacity_ratio": "1.4"}, "relaxation_time", "heat_capacity_ratio > 1"),
        (GAS, {"seal_friction": "0.1"}, "seal_presliding", "seal_friction > 0"),
        (FRICTION, {"static_rise": "0.1"}, "stribeck_velocity", "static_rise > 0"),
        (FRICTION, {"ripple": "0.1"}, "ripple_period", "ripple > 0"),
        (FRICTION, {"load_coefficient": "0.1"}, "element", "load_coefficient > 0"),
        (
            TABLE,
            {"presliding_stiffness": ""},
            "presliding_stiffness",
            "torques that differ between forward and backward",
        ),
    ],
)
def test_attribute_that_another_one_needs(law: Law, given: dict[str, str], missing: str, reason: str):
    assert f"attribute {missing} is missing; it is needed with {reason}" in refusal(mjcf(element(law, **given)))


@pytest.mark.parametrize(
    ("law", "name"),
    [(GAS, "constant"), (GAS, "critical_length"), (FRICTION, "coulomb"), (FRICTION, "presliding_stiffness")]
    + [(TABLE, name) for name in ("angle_min", "angle_max", "forward", "backward")],
)
def test_required(law: Law, name: str):
    assert f"attribute {name} is missing; it must be" in refusal(mjcf(element(law, **{name: ""})))


@pytest.mark.parametrize(("law", "name"), [(GAS, "constant"), (FRICTION, "coulomb"), (TABLE, "forward")])
def test_blanks_are_nothing(law: Law, name: str):
    assert f"attribute {name} is missing; it must be" in refusal(mjcf(element(law, **{name: "   "})))


def test_blanks_behind_a_value():
    given = {"coulomb": "7   ", "ripple_period": "  ", "element": "rod   ", "load_coefficient": "0.1  "}
    mujoco.MjModel.from_xml_string(mjcf(element(FRICTION, **given)))
    assert "attribute coulomb = '-7' must be" in refusal(mjcf(element(FRICTION, coulomb="-7   ")))


def test_unknown_attribute():
    with pytest.raises(ValueError, match="coulumb"):
        mujoco.MjModel.from_xml_string(mjcf(element(FRICTION, coulumb="1")))


def test_long_value_is_cut_in_the_message():
    message = refusal(mjcf(element(TABLE, forward="1 " * 5000 + "x")))
    assert f"forward = '{'1 ' * 20}...' must be finite numbers" in message


def test_gas_spring_needs_a_spatial_tendon():
    for target in ('joint="x"', 'tendon="gear"'):
        text = mjcf(element(GAS).replace('tendon="rod"', target))
        assert "must act on a spatial tendon" in refusal(text)


def test_shared_instance_needs_one_number_or_one_for_each():
    users = "".join(f'<plugin joint="{joint}" instance="both"/>' for joint in "xw")
    instance = f'<instance name="both">{attributes(FRICTION, coulomb="1 2 3")}</instance>'
    message = refusal(mjcf(users, extension=instance))
    assert "coulomb = '1 2 3' must be one number, or one for each actuator of its plugin instance" in message


def test_faults_leave_the_process_in_order():
    """Many failed compilations, then a good one."""
    for _ in range(50):
        refusal(mjcf(element(GAS) + element(FRICTION, "bad", coulomb="-1")))
    mujoco.MjModel.from_xml_string(mjcf(element(GAS)))


class _Plugin(ctypes.Structure):
    """Head of mjpPlugin."""

    _fields_ = (("name", ctypes.c_char_p), ("count", ctypes.c_int), ("attributes", ctypes.POINTER(ctypes.c_char_p)))


@pytest.mark.parametrize("law", [GasSpring, Friction, TorqueTable])
def test_attributes_are_the_fields_of_the_twin(law: type[Law]):
    library = ctypes.CDLL(str(next(Path(mujoco.__file__).parent.glob("libmujoco*"))))
    library.mjp_getPlugin.restype = ctypes.POINTER(_Plugin)
    plugin = library.mjp_getPlugin(NAMES[law].encode(), None).contents
    assert {name.decode() for name in plugin.attributes[: plugin.count]} == {field.name for field in fields(law)}
