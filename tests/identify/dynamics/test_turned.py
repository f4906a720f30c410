"""An axis that counts the other way round in angle and torque alike is found, whatever the links weigh."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identify.dynamics.turned import turned_axis
from bench.record.campaign import Campaign
from tests.identify.dynamics.rigid_world import Friction, arm, drawn, recorded, robot

CRUDE = {"mass": 0.3, "centre_of_mass_m": 0.03, "rotor_inertia": 0.3}
FRICTION = Friction(np.array([20.0, 15.0, 8.0]), np.array([30.0, 20.0, 10.0]), np.array([1.0, -2.0, 0.5]))


def turned(campaign: Campaign, axis: int, quantities: tuple[str, ...]) -> Campaign:
    """Return a campaign in which some quantities of an axis have the other sign."""
    names = tuple(f"{quantity}_{axis + 1}_" for quantity in quantities)
    runs = tuple(
        replace(run, columns={name: -v if name.startswith(names) else v for name, v in run.columns.items()})
        for run in campaign.runs
    )
    return replace(campaign, runs=runs)


@pytest.fixture
def campaign(rng: np.random.Generator) -> Campaign:
    return recorded(drawn(robot(arm(), **CRUDE), rng), FRICTION, rng)


def test_of_axes_that_turn_as_they_should_nothing_is_said(campaign: Campaign) -> None:
    assert turned_axis(campaign, robot(arm(), **CRUDE)) is None


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_angle_that_is_turned_by_itself_is_told(campaign: Campaign, axis: int) -> None:
    """Its friction would give energy; an angle of a stranger's arm with two joints was believed so."""
    found = turned_axis(turned(campaign, axis, ("q_motor",)), robot(arm(), **CRUDE))
    assert found
    assert (found.indices, found.alone) == ((axis,), True)
    assert found.after < 0.5 * found.before


@pytest.mark.parametrize("axis", [1, 2])
def test_the_axis_that_is_turned_is_told(campaign: Campaign, axis: int) -> None:
    """Beside its parallel neighbour: with both turned, such an arm is nearly itself turned round by half a turn."""
    found = turned_axis(turned(campaign, axis, ("q_motor", "tau_motor")), robot(arm(), **CRUDE))
    assert found
    assert not found.alone
    assert axis in found.indices
    assert set(found.indices) <= {1, 2}
    assert found.after < 0.5 * found.before


def test_what_the_mirror_image_of_an_arm_does_is_no_error(campaign: Campaign) -> None:
    """About an upright first axis it turns the other way round, and its links weigh as much on the other side."""
    assert turned_axis(turned(campaign, 0, ("q_motor", "tau_motor")), robot(arm(), **CRUDE)) is None


def test_a_motion_of_seconds_tells_nothing(rng: np.random.Generator) -> None:
    short = recorded(robot(arm()), FRICTION, rng, runs=1, seconds=3.0)
    assert turned_axis(turned(short, 1, ("q_motor", "tau_motor")), robot(arm())) is None
