"""What can be tried about an extended model, and what it takes for that."""

from dataclasses import replace

import numpy as np

from bench.diagnose.extend.objective import Objective
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import causes_of
from bench.diagnose.linearise.lack_of_fit import missed
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.linearise.other_noise import raised
from bench.diagnose.linearise.repeated_rests import repeating_visits
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.name.models import Model
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.name.selection import name_cause
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import World, edits_in
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import Acting
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import LOADS, SWEEPS, made, nominal

SIZES = {"coulomb_friction": {"level": 100.0}, "viscous_friction": {"coefficient": 300.0}, "link_mass": {"change": 0.1}}
MORE = ("coulomb_level", "viscous_level", "direction_friction", "direction_viscous")


def test_more_of_a_friction_needs_the_friction_that_was_found() -> None:
    """Without it there is none to have more of: such a name stood in the place of viscous friction in each search."""
    kr300 = compile_robot(load_robot("kr300"))
    effects = {name: effect for name, effect in catalogue().items() if name in (*SIZES, *MORE)}
    measured = frozenset({"tau_motor"})
    here = [cause for cause in causes_of(effects.values(), kr300, measured) if cause.effect.name in SIZES]
    found = [next(cause for cause in here if cause.effect.name == name) for name in SIZES]
    world = World(acting=tuple(Acting(one.effect, one.place, SIZES[one.effect.name]) for one in found))
    around = Neighbourhood(kr300, effects, measured, 0.01)
    coulomb, viscous, _ = (cause.key for cause in found)

    def robot_of(world: World) -> CompiledRobot:
        return compile_robot(kr300.robot, edits_in(world, Conditions.reference(kr300.n_joints)))

    assert around.needs(found, world, robot_of) == {
        ("coulomb_level", "joint 1"): {coulomb},
        ("direction_friction", "joint 1"): {coulomb},
        ("viscous_level", "joint 1"): {viscous},
        ("direction_viscous", "joint 1"): {coulomb, viscous},
    }


def test_what_counts_as_noise_is_what_a_fit_leaves() -> None:
    """It was what figures leave that are free to change; with larger errors they left more, on the KR300 60 times."""
    campaign = made(SWEEPS, 3, {"gas_loss": 0.1})
    robot, effects = nominal(), {"gas_loss": catalogue()["gas_loss"]}
    quantities = quantities_of(campaign.runs, robot)
    measured = frozenset(quantity.kind for quantity in quantities)
    nuisances, segments = nuisances_of(robot, quantities), segments_of(campaign, robot, quantities)
    causes = causes_of(effects.values(), robot, measured)
    sensitivities = Signatures(robot, quantities, nuisances, causes).sensitivities(segments)
    linear = linearised_model_of(Replay(robot, segments, quantities), nuisances, sensitivities.nuisances)
    around = Neighbourhood(robot, effects, measured, 0.01)
    linear, _ = around.weighed(linear, causes, sensitivities)
    fit = refit(linear, causes, {})
    off = np.array([nuisance.name.startswith("torque constant") for nuisance in linear.nuisances], dtype=float)
    there = Objective(linear, causes).at(fit.nuisances + 3 * off, fit.values)
    left = replace(fit, nuisances=there.nuisances, residual=there.residual)
    about, _ = around.about(linear, Model(left), is_last=True)
    expected = np.maximum(missed(linear, there.white, is_last=True) * linear.inflation, about.unexplained)
    np.testing.assert_allclose(about.inflation, expected, rtol=0.02)  # friction of the model scatters otherwise
    assert np.max(about.inflation) > 2


def test_what_is_tried_stands_by_whatever_was_looked_at_meanwhile() -> None:
    """How much friction at rest repeats is asked about other designs: columns of the first were let go with that."""
    campaign = made(LOADS, 3)
    again = tuple(replace(run, name=f"{run.name}-again", start_s=run.start_s + 1e4) for run in campaign.runs)
    campaign = replace(campaign, runs=(*campaign.runs, *again))
    robot, effects = nominal(), {"gas_loss": catalogue()["gas_loss"]}
    quantities = quantities_of(campaign.runs, robot)
    nuisances, segments = nuisances_of(robot, quantities), segments_of(campaign, robot, quantities)
    assert repeating_visits(segments)
    measured = frozenset(quantity.kind for quantity in quantities)
    causes = causes_of(effects.values(), robot, measured)
    sensitivities = Signatures(robot, quantities, nuisances, causes).sensitivities(segments)
    linear = linearised_model_of(Replay(robot, segments, quantities), nuisances, sensitivities.nuisances)
    around = Neighbourhood(robot, effects, measured, 0.01)
    linear, screening = around.weighed(linear, causes, sensitivities)
    assert name_cause(linear, screening, around).kind == "nothing found"
    around.everything(raised(linear, np.full_like(linear.inflation, 2.0)))
    assert name_cause(linear, screening, around).kind == "nothing found"
