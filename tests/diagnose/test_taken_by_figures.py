"""An effect that the data show, and a fitted figure takes, is not called unseen."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.verdict import UndetectableEffect
from bench.hide.campaign import hide_campaign
from bench.report.diagnosis.blind import blind_sentences
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.test_given import BINS
from tests.report.diagnosis.made import NOTHING
from tests.report.handover.made import EFFECTS, torque_robot
from tests.simulate.rotation_small import small_rotation


@pytest.mark.parametrize(("friction", "taken"), [(3.0, True), (0.01, False)])
def test_a_level_of_friction_that_a_figure_may_have(tmp_path: Path, friction: float, taken: bool) -> None:
    """Only joint 1 moves. The friction of joint 2 no reading shows, however well it is known."""
    small = load_robot(torque_robot(tmp_path / "small"))
    known = small.figures.uncertainty.model_copy(update={"friction": friction})
    robot = replace(small, figures=small.figures.model_copy(update={"uncertainty": known}))
    rng = np.random.default_rng(1)
    campaign = hide_campaign(robot, small_rotation(small.folder), [], rng, background=False).campaign
    sought = {"coulomb_level": EFFECTS["coulomb_level"]}
    blind = diagnose(campaign, compile_robot(robot), sought, most_bins=BINS).verdict.blind
    found = {place: spot.taken_by for spot in blind for place in spot.places}
    assert found["joint 2"] == ()
    assert ("joint 1" in found) == taken
    if taken:
        (figure,) = found["joint 1"]
        assert figure.endswith("Coulomb friction of hinge_a")


def test_it_is_said_under_which_figure() -> None:
    level = UndetectableEffect("coulomb_level", ("joint 1", "joint 2"), ("q_link",), ("friction of a", "friction of b"))
    unseen = UndetectableEffect("base_torsion", ("robot",), ())
    words = list(blind_sentences(replace(NOTHING, blind=(level, unseen))))
    assert words == [
        "Not to be seen here; other joints, speeds, loads or hours may show: torsion of the base.",
        "No findings of their own here, for fitted figures may be as far off and change the readings in the same way: "
        "Coulomb level (joints 1, 2). What the figures came out as is in figures.csv (friction).",
        "These runs with link encoders (q_link_i_rad; of a slide q_link_i_m) would show more of: Coulomb level "
        "(joints 1, 2).",
    ]
