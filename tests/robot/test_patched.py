"""A patched model is the compiled one: every number that physics uses, its forces, and the figures of the robot."""

import gc
import weakref
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from pathlib import Path

import mujoco
import numpy as np
import pytest

import bench.effects.geometry_at_zero as geometry_at_zero
import bench.robot.patched as patched_module
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import Effect, Place
from bench.effects.learned import values_at
from bench.effects.learned_torques import LearnedCompliance
from bench.effects.nominal import nominal_parameters
from bench.effects.unlisted import unlisted
from bench.errors import RobotError
from bench.predict.another_payload import AnotherPayload
from bench.robot.compiled import SpecEdit
from bench.robot.folder import Robot, load_robot
from bench.robot.patched import Step, Unpatched
from bench.robot.plugins import configure
from bench.simulate.payload import bolt_on
from tests.effects.rest import places_of
from tests.robot.both import Both, assert_same

LATER = 3600.0  # [s], after all that sets in
PAYLOAD = 12.0  # [kg]
NODES = np.array([-0.5, 0.0, 0.5])  # [rad]
OTHERS = (AnotherPayload(), LearnedCompliance(values_at(NODES, "rad", "", 0.3), NODES))
EFFECTS = {
    name: effect
    for name, effect in {**catalogue(), **unlisted(), **{one.name: one for one in OTHERS}}.items()
    if type(effect).edit is not Effect.edit
}
ROBOTS = ("small", "hh150", "kr300", "emps")


@cache
def both_of(folder: str) -> Both:
    return Both(load_robot(folder))


@pytest.fixture(params=ROBOTS)
def both(request: pytest.FixtureRequest, small_robot: Path) -> Both:
    return both_of(str(small_robot) if request.param == "small" else request.param)


@pytest.fixture
def never_compiled(both: Both, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*args: object) -> None:
        raise AssertionError("compiled instead of patched")

    monkeypatch.setattr(patched_module, "compile_spec", refuse)


def warm(n: int) -> Conditions:
    return Conditions(np.full(n, 308.15), np.full(n, 323.15), ambient_k=298.15, payload_kg=PAYLOAD, time_s=LATER)


def typical_edit(effect: Effect, both: Both, place: Place) -> SpecEdit:
    values = {one.name: one.typical for one in effect.parameters_at(both.nominal, place)}
    edit = effect.edit(place, effect.complete(values), warm(both.nominal.n_joints))
    assert edit
    return edit


@pytest.mark.usefixtures("never_compiled")
@pytest.mark.parametrize("name", EFFECTS)
def test_every_effect_at_every_place(name: str, both: Both) -> None:
    """Other sizes come first, so that the structure was made for other numbers than those compared."""
    effect = EFFECTS[name]
    for place in places_of(effect, both.nominal):
        values = {
            one.name: one.null if one.is_shape else one.null + one.high
            for one in effect.parameters_at(both.nominal, place)
        }
        other = effect.edit(place, effect.complete(values), warm(both.nominal.n_joints))
        assert other
        both.patched([other])
        edits = [bolt_on(PAYLOAD), typical_edit(effect, both, place)]
        assert_same(both.patched(edits), both.compiled(edits))


@pytest.mark.usefixtures("never_compiled")
def test_every_nominal_parameter(both: Both) -> None:
    for parameter in nominal_parameters(both.nominal):
        edits = [parameter.edit(parameter.sigma)]
        assert_same(both.patched(edits), both.compiled(edits))


@pytest.mark.usefixtures("never_compiled")
def test_combinations(both: Both) -> None:
    """Payload, all deviations and two effects, of which either may come first; most steps are those of the last."""
    payload = bolt_on(PAYLOAD)
    deviations = [one.edit((-1) ** i * one.sigma) for i, one in enumerate(nominal_parameters(both.nominal))]
    acting = [
        typical_edit(effect, both, place)
        for effect in EFFECTS.values()
        for place in places_of(effect, both.nominal)[-1:]
    ]
    rng = np.random.default_rng(3)
    for _ in range(30):
        first, second = rng.choice(len(acting), 2, replace=False)
        edits = [payload, *deviations, acting[first], acting[second]]
        assert_same(both.patched(edits), both.compiled(edits))


@pytest.mark.parametrize("name", ["transmission_error", "payload_com", "bearing_tilt", "wrist_coupling"])
@pytest.mark.parametrize(
    "other", ["gas_loss", "counterbalance_gas", "friction_ripple", "coulomb_friction", "link_mass"]
)
def test_a_structure_keeps_nothing_of_the_robot_in_which_it_was_first_met(name: str, other: str, both: Both) -> None:
    """Gas that was there when a gear error was met first once stayed in every later robot with a gear error."""
    fresh = Both(both.robot)
    where = [EFFECTS[one].places(fresh.nominal) for one in (name, other)]
    if not all(where):
        return  # this robot has no such part
    structural, numbers = (
        typical_edit(EFFECTS[one], fresh, places[0]) for one, places in zip((name, other), where, strict=True)
    )
    for edits in ([bolt_on(PAYLOAD), numbers, structural], [bolt_on(PAYLOAD), structural]):
        assert_same(fresh.patched(edits), fresh.compiled(edits))


def test_a_length_is_that_of_where_things_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is kept for robots that have everything in its place, whatever else differs, and made anew for others."""
    both, made = Both(load_robot("hh150")), list[object]()
    seal, anchors = (EFFECTS[name] for name in ("seal_friction", "anchor"))
    (place,) = seal.places(both.nominal)
    rubs = seal.edit(place, {"share": 0.05}, warm(6))
    moved = [anchors.edit(place, {"a": x, "b": 0.0, "h": 0.0}, warm(6)) for x in (4e-3, -3e-3)]
    lengths = geometry_at_zero.AtZero.length
    monkeypatch.setattr(
        geometry_at_zero.AtZero, "length", lambda self, tendon: made.append(self) or lengths(self, tendon)
    )
    assert rubs
    assert all(moved)
    for edits in ([moved[0], rubs], [moved[1], rubs], [moved[0], bolt_on(PAYLOAD), rubs]):
        patched = both.patched(edits)
        count = len(made)
        assert_same(patched, both.compiled(edits))
        del made[count:]  # a robot that is compiled has nothing kept
    assert len(made) == 2  # of the third, as of the first


def test_the_spec_stays_as_it_was(both: Both) -> None:
    for effect in EFFECTS.values():
        for place in places_of(effect, both.nominal)[:1]:
            both.patched([typical_edit(effect, both, place)])
    assert both.spec.to_xml() == both.before
    assert_same(both.patched(()), both.compiled(()))


def with_a_stand(spec: mujoco.MjSpec, robot: Robot) -> None:
    spec.worldbody.add_body(name="stand")


def with_memory(spec: mujoco.MjSpec, robot: Robot) -> None:
    spec.memory = 1 << 20


def negative_friction(spec: mujoco.MjSpec, robot: Robot) -> None:
    configure(spec, robot.figures.drives[0].motor_friction, coulomb=-1.0)


def negative_mass(spec: mujoco.MjSpec, robot: Robot) -> None:
    spec.body(robot.figures.load_body).mass = -1.0


def no_stiffness(spec: mujoco.MjSpec, robot: Robot) -> None:
    spec.tendon(robot.figures.drives[0].element).stiffness = np.zeros(3)


def shifted_load(spec: mujoco.MjSpec, robot: Robot) -> None:
    spec.body(robot.figures.load_body).ipos = np.array([0.0, 0.0, 0.01])


def lopsided(spec: mujoco.MjSpec, robot: Robot) -> None:
    spec.body(robot.figures.load_body).inertia = np.array([1.0, 1.0, 3.0])


@pytest.mark.parametrize("edit", [negative_friction, negative_mass, no_stiffness, shifted_load, lopsided])
def test_refused_as_when_compiled(edit: SpecEdit, both: Both, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings to MUJOCO_LOG.TXT
    with pytest.raises(RobotError) as compiled:
        both.compiled([edit])
    with pytest.raises(RobotError) as patched:
        both.patched([edit])
    assert str(patched.value) == str(compiled.value)


@pytest.mark.parametrize("edit", [with_a_stand, with_memory, Unpatched(bolt_on(3.0))])
def test_what_cannot_be_patched_is_compiled(edit: SpecEdit, both: Both) -> None:
    assert_same(both.patched([edit]), both.compiled([edit]))


def test_a_structure_goes_with_who_made_it(both: Both) -> None:
    """At once, not when garbage is collected next: a study grew by gigabytes of models that nobody used any more."""
    fresh = Both(both.robot)
    for effect in list(EFFECTS.values())[:12]:
        for place in effect.places(fresh.nominal)[:1]:
            fresh.patched([bolt_on(PAYLOAD), typical_edit(effect, fresh, place)])
    kept = weakref.ref(fresh.structure)
    gc.disable()
    try:
        del fresh
        assert kept() is None
    finally:
        gc.enable()


def test_several_threads(both: Both) -> None:
    load = both.nominal.at.load_body

    def mass(wanted: int) -> float:
        return float(both.patched([bolt_on(float(wanted))]).model.body_mass[load])

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(mass, range(1, 400))) == list(range(1, 400))


def test_robots_that_are_alive_share_no_model(both: Both) -> None:
    kept = [both.patched([bolt_on(float(mass))]) for mass in range(1, 40)]
    load = both.nominal.at.load_body
    assert [one.model.body_mass[load] for one in kept] == list(range(1, 40))
    data = mujoco.MjData(kept[0].model)
    del kept
    others = [both.patched([bolt_on(50.0)]) for _ in range(40)]
    assert data.model.body_mass[load] == 1.0
    assert len({one.model._address for one in others} | {data.model._address}) == 41


def test_a_robot_that_was_asked_for_just_now_is_not_made_again(both: Both) -> None:
    edits = [bolt_on(PAYLOAD), bolt_on(2 * PAYLOAD)]
    first, second = (both.patched([edit]) for edit in edits)
    assert both.patched(edits[:1]) is first
    assert both.patched(edits[1:]) is second
    for i in range(patched_module.MOST_ROBOTS):  # others are forgotten at last
        both.structure.robot([Step(i, partial(tuple, edits[:1]))])
    assert both.patched(edits[:1]) is not first
    assert_same(both.patched(edits[:1]), first)
