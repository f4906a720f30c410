"""An effect that the data show, and a fitted figure takes, is not called unseen."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.diagnose import diagnose
from bench.diagnose.verdict import UndetectableEffect
from bench.effects.effect import Acting, Place
from bench.hide.campaign import hide_campaign
from bench.report.diagnosis.blind import blind_sentences
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.test_given import BINS
from tests.report.diagnosis.made import NOTHING
from tests.report.handover.made import EFFECTS, torque_robot
from tests.simulate.rotation_small import small_rotation
from tests.small_robot import FRICTION

HELD = 300.0  # [Nm], more than the load of a joint that stands changes by


@pytest.mark.parametrize(("friction", "taken"), [(3.0, True), (0.01, False)])
def test_a_level_of_friction_that_a_figure_may_have(tmp_path: Path, friction: float, taken: bool) -> None:
    """Only joint 1 moves. What holds joint 2 no reading shows, however well it is known."""
    found = taken_by(tmp_path, friction, HELD)
    assert found["joint 2"] == ()
    assert ("joint 1" in found) == taken
    if taken:
        (figure,) = found["joint 1"]
        assert figure.endswith("Coulomb friction of hinge_a")


def test_friction_of_a_standing_joint_shows_where_its_link_is_pushed_over_it(tmp_path: Path) -> None:
    """In the plant the torque of joint 2 shows most of what its level grew by, and a diagnosis knows that."""
    small = load_robot(torque_robot(tmp_path / "plant"))
    higher = Acting(EFFECTS["coulomb_level"], Place("joint", 1, "hinge_b"), {"change": 0.3})
    plain, more = (
        hide_campaign(small, small_rotation(small.folder), acting, np.random.default_rng(1), background=False).campaign
        for acting in ([], [higher])
    )
    torque = "tau_motor_2_nm"
    for one, other in zip(plain.runs, more.runs, strict=True):
        assert np.max(np.abs(other.columns[torque] - one.columns[torque])) > 0.8 * 0.3 * FRICTION[1]
    assert "joint 2" not in taken_by(tmp_path, 0.01, FRICTION[1])


def taken_by(folder: Path, friction: float, level: float) -> dict[str, tuple[str, ...]]:
    """Return the places of Coulomb levels that cannot be seen, and the figures that take them.

    Args:
        folder: Where to write.
        friction: How well it is known, as a share of it.
        level: Of joint 2 [Nm].
    """
    small = load_robot(torque_robot(folder / "small"))
    file = small.folder / "small.xml"
    coulomb = '<config key="coulomb" value="{}"/>'
    text = file.read_text()
    assert coulomb.format(FRICTION[1]) in text
    file.write_text(text.replace(coulomb.format(FRICTION[1]), coulomb.format(level)))
    known = small.figures.uncertainty.model_copy(update={"friction": friction})
    robot = replace(small, figures=small.figures.model_copy(update={"uncertainty": known}))
    rng = np.random.default_rng(1)
    campaign = hide_campaign(robot, small_rotation(small.folder), [], rng, background=False).campaign
    sought = {"coulomb_level": EFFECTS["coulomb_level"]}
    blind = diagnose(campaign, compile_robot(robot), sought, most_bins=BINS).verdict.blind
    return {place: spot.taken_by for spot in blind for place in spot.places}


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
