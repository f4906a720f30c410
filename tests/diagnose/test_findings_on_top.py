"""A finding that an earlier diagnosis left may be off a little: from where it is, and not from where it never was."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.diagnose.replay.given import PosteriorParameter, finding_on_top
from bench.effects.conditions import Conditions
from bench.effects.effect import Effect
from bench.robot.compiled import compile_robot, compile_spec, read_spec
from bench.robot.folder import load_robot
from bench.robot.plugins import attributes_of
from bench.robot.write import write_robot
from tests.effects.rest import CATALOGUE, places_of, typical

PLAIN = compile_robot(load_robot("hh150"))
EDITED = [
    name for name, effect in CATALOGUE.items() if type(effect).edit is not Effect.edit and places_of(effect, PLAIN)
]
NEXT_TO_NOTHING = 1e-6  # of the largest plausible size
CLOSE = 5e-3  # relative; what is there is a tenth of the largest plausible size or more


def drawn(spec: mujoco.MjSpec) -> dict[str, dict[str, np.ndarray]]:
    """Return the numbers of every actuator that has a law of the engine plugin."""
    found = {}
    for actuator in spec.actuators:
        if actuator.plugin.active:
            own = attributes_of(spec, actuator.name)
            found[actuator.name] = {
                k: np.array(v.split(), dtype=float) for k, v in own.items() if v[:1] in "+-.0123456789"
            }
    return found


@pytest.mark.filterwarnings("ignore:Inertia matrix is too close to singular")  # of what hardly bends
@pytest.mark.parametrize("name", EDITED)
def test_a_finding_that_is_hardly_off_leaves_the_robot_as_it_is(name: str, tmp_path: Path) -> None:
    """A ripple of friction that was off by a tenth became that tenth: its elements were set, and not added to."""
    effect = CATALOGUE[name]
    place = places_of(effect, PLAIN)[-1]
    values = typical(effect, PLAIN, place)
    edit = effect.edit(place, values, Conditions.reference(PLAIN.n_joints))
    if edit is None:  # under the conditions at which figures hold
        pytest.skip("it is in no model that is handed over")
    spec = read_spec(PLAIN.robot)
    compile_spec(spec, PLAIN.robot, [edit])
    write_robot(PLAIN.robot, spec, PLAIN.robot.figures, tmp_path / "robot", "")
    handed = compile_robot(load_robot(tmp_path / "robot"))
    before = drawn(read_spec(handed.robot))
    shapes = {p.name: values[p.name] for p in effect.parameters if p.is_shape}
    for p in effect.parameters:
        if p.is_shape:
            continue
        left = PosteriorParameter(p.name, p.unit, p.high, values[p.name], name, place.name or "robot", p.name, shapes)
        small = NEXT_TO_NOTHING * p.high
        nuisance = finding_on_top(left, small, handed)
        if nuisance is None:  # taken as it was found
            continue
        assert nuisance.edit
        off = read_spec(handed.robot)
        model = compile_spec(off, handed.robot, [nuisance.edit(small)]).model
        after = drawn(off)
        for actuator, own in before.items():
            for key, numbers in own.items():
                np.testing.assert_allclose(after[actuator][key], numbers, rtol=CLOSE, err_msg=f"{p.name}: {key}")
        m = handed.model.nbody
        np.testing.assert_allclose(model.body_mass[:m], handed.model.body_mass, rtol=CLOSE, atol=1e-6)
