"""What free shapes can follow: a ripple of a torque over an angle that is wide, and a gauge that sticks."""

import numpy as np
import pytest

from bench.diagnose.linearise.generic import FINE_NODES, Block, anew, blocks_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import tried_of
from bench.diagnose.name.discrepancy import effect_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.effect import WHOLE, Acting
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import SWEEPS, made

WIDE = SWEEPS.model_copy(
    update={"joint": 3, "start_deg": (0.0, 0.0, -62.0, 0.0, 90.0, 0.0), "end_deg": 31.0, "speeds_deg_per_s": (15.0,)}
)
CYCLES = 30  # of a turn: 12 degrees each, four bins of this sweep
MOST_LEFT = 0.1  # of its squares: what straight lines between 33 nodes leave of a sine of 7.8 such cycles, and noise


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    return linear_of(made(WIDE, seed=4))


@pytest.fixture(scope="module")
def over_angle(linear: LinearisedModel) -> list[Block]:
    asked = ("joint 3", "motor torque", "angle")
    return [block for block in blocks_of(linear) if (block.place, block.kind, block.depends_on) == asked]


def test_a_ripple_of_twelve_degrees_is_a_torque_over_a_wide_angle(
    linear: LinearisedModel, over_angle: list[Block]
) -> None:
    """With 17 nodes over 93 degrees it was noise: "the nominal model explains this campaign", ten times as far off."""
    trace = linear.replay.trace(NOMINAL)
    phases = np.stack([np.sin(CYCLES * trace.q[:, 2]), np.cos(CYCLES * trace.q[:, 2])], axis=1)
    raw = np.zeros((*linear.replay.predict(NOMINAL).shape, 2))
    (current,) = (c for c, quantity in enumerate(linear.quantities) if quantity.column == "current_3_a")
    raw[:, current] = phases
    ripple = linear.whiten(raw)
    left = [np.sum((ripple - b.columns @ np.linalg.lstsq(b.columns, ripple)[0]) ** 2) for b in over_angle]
    assert min(left) < MOST_LEFT * np.sum(ripple**2)


def test_a_gauge_that_sticks_is_an_error_of_its_readings() -> None:
    """Its lag is one of pressure, the same at each speed; the only lag that was known was one of time, at 100 %."""
    linear = linear_of(made(SWEEPS, seed=4))
    (block,) = (block for block in blocks_of(linear) if block.place == "gauge")
    (gauge,) = (c for c, quantity in enumerate(linear.quantities) if quantity.kind == "gas_pressure")
    stuck = np.zeros(linear.replay.predict(NOMINAL).shape)
    stuck[:, gauge] = -4e5 * np.sign(linear.replay.trace(NOMINAL).q_velocity[:, 1])
    white = linear.whiten(stuck)
    left = white - block.columns @ np.linalg.lstsq(block.columns, white)[0]
    assert left @ left < MOST_LEFT * white @ white
    effect = effect_of(linear, block)
    assert effect
    values = effect.complete({parameter.name: -4e5 for parameter in effect.parameters})
    changed = linear.replay.predict(World(acting=(Acting(effect, WHOLE, values),))) - linear.replay.predict(NOMINAL)
    np.testing.assert_allclose(changed[:, gauge], stuck[:, gauge], atol=1.0)


def test_a_shape_made_anew_has_as_many_nodes(linear: LinearisedModel, over_angle: list[Block]) -> None:
    """A diagnosis ended in a traceback where its unlisted cause was of the finer kind."""
    for block in over_angle:
        assert anew(linear, block).columns.shape == block.columns.shape


def test_shapes_of_both_kinds_share_their_odds(over_angle: list[Block]) -> None:
    coarse, fine = tried_of(over_angle).entries
    assert len(fine.columns) == FINE_NODES
    assert [share for _, share in coarse.priors] == [share for _, share in fine.priors]
    assert sum(np.exp(share) for entry in (coarse, fine) for _, share in entry.priors) == pytest.approx(1.0)
