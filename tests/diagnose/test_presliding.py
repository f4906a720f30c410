"""How stiff friction elements hold is a figure that may be off, and no cause."""

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Acting, Effect, Parameter, Place, Values
from bench.effects.nominal import presliding_parameters
from bench.robot.compiled import SpecEdit
from bench.robot.folder import Robot
from bench.robot.plugins import configure, number_of
from tests.diagnose.noise_free import linearised, noise_free
from tests.diagnose.small_models import chi_square_left
from tests.diagnose.sweeps import nominal

SOFTER = 5.0


class SofterPresliding(Effect):
    """Friction of links takes a longer travel to build up, in all joints."""

    name = "softer_presliding"
    family = "own"
    title = "softer presliding of all links"
    physics = "Every friction element of a link holds more softly."
    source = "made up"
    parameters = (Parameter("times", "", 1.0, 1.0, 10.0, "softer"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit:
        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            for drive in robot.figures.drives:
                stiffness = number_of(spec, drive.link_friction, "presliding_stiffness")
                configure(spec, drive.link_friction, presliding_stiffness=stiffness / values["times"])

        return change


def test_every_friction_element_with_a_level_has_a_figure_known_to_a_factor_of_three() -> None:
    found = presliding_parameters(nominal())
    assert len(found) == 12
    assert all(one.is_factor for one in found)
    np.testing.assert_allclose([1 + one.off_by(one.sigma) for one in found], 3.0)
    names = {one.name for one in found}
    assert "presliding stiffness on the link side of joint2" in names


def test_presliding_five_times_softer_is_told_by_these_figures() -> None:
    effect = SofterPresliding()
    linear = linearised(noise_free("session-short", 4, (Acting(effect, Place("all"), {"times": SOFTER}),)))
    without, with_them = (chi_square_left(linear, linear.white, *names) for names in (("presliding",), ()))
    print(f"chi-square {without:.0f} without, {with_them:.0f} with figures for presliding")
    assert without - with_them > 2 * np.log(100)  # else some cause would have had those odds to explain
