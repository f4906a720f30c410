"""Gas that relaxes does so in the replay for as long as in the robot: between motions, in waiting, in a long stay."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.replay.static_segments import LATER
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.simulate.plant import Plant
from tests.diagnose.noise_free import linearised, noise_free

EXCESS, TAU = 0.05, 40.0


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


@pytest.fixture(scope="module")
def relaxing(compiled: CompiledRobot) -> Acting:
    effect = catalogue()["thermal_relaxation"]
    (place,) = effect.places(compiled)
    return Acting(effect, place, {"gamma_excess": EXCESS, "relaxation_time": TAU})


def test_gas_relaxes_while_a_robot_waits(compiled: CompiledRobot, relaxing: Acting) -> None:
    """A plant that stands for a minute without being simulated is as far as one that is simulated for that long."""
    edit = relaxing.effect.edit(relaxing.place, relaxing.values, None)  # type: ignore[arg-type]
    assert edit
    there, wrench = np.deg2rad([[0.0, 60, -20, 0, 60, 0]]), np.zeros((1, 6))
    forces = []
    for is_simulated in (False, True):
        plant = Plant(compiled.robot, [edit])
        plant.reset(np.zeros(6))
        way = there * np.linspace(0, 1, 250)[:, None]
        plant.advance(way, np.tile(wrench, (250, 1)), 0.004)
        hot = plant.advance(np.tile(there, (500, 1)), np.tile(wrench, (500, 1)), 0.004).gas_force[-1]
        if is_simulated:
            plant.advance(np.tile(there, (15_000, 1)), np.tile(wrench, (15_000, 1)), 0.004)
        else:
            plant.wait(60.0)
        forces.append(plant.look().gas_force[0] / hot)
    assert forces[1] < 0.99
    assert forces[0] == pytest.approx(forces[1], abs=1e-4)


def test_a_replay_lets_gas_relax_for_as_long_as_the_robot_did(compiled: CompiledRobot, relaxing: Acting) -> None:
    """Between two sweeps is less than the second that an approach is assumed to take; a dwell is read for ten minutes.

    A replay that let the approach begin before the sweep before had ended missed a tenth of the pressure on the way
    back; one that took the dwell for a single rest, most of it.
    """
    every = []
    for acting in ((relaxing,), ()):
        replay = linearised(noise_free("session-study", acting=acting)).replay
        made = replay.predict(World(acting=acting) if acting else NOMINAL)
        every.append((replay, np.concatenate([s.observed for s in replay.segments]), made))
    (replay, seen, made), (_, before, nominal) = every
    gauge = [quantity.column for quantity in replay.quantities].index("gas_pressure_pa")
    change, missed = (seen - before)[:, gauge], (seen - before - made + nominal)[:, gauge]
    run_of = np.repeat([s.run for s in replay.segments], [len(s) for s in replay.segments])
    for run in ("joint2-payload100-speed40-up", "joint2-payload100-speed40-down", "joint2-payload50-speed18-down"):
        rows = run_of == run
        assert np.sqrt(np.mean(missed[rows] ** 2)) < 0.04 * np.sqrt(np.mean(change[rows] ** 2)), run
    dwell = run_of == "dwell"
    assert dwell.sum() == 6
    largest = np.max(np.abs(change))
    assert np.max(np.abs(missed[dwell])) < 0.1 * largest


def test_gas_is_as_warm_whichever_models_follow_the_runs(compiled: CompiledRobot, relaxing: Acting) -> None:
    """Stiffness that hardly depends on the temperature made a model of each run, and each began with cool gas.

    Whatever depends on temperatures had that in common, and with it a delay of the gauge, at more than 0.999.
    """
    effect = catalogue()["compliance_temperature"]
    place = next(place for place in effect.places(compiled) if place.index == 0)
    hardly = Acting(effect, place, {parameter.name: 1e-9 for parameter in effect.parameters})
    replay = linearised(noise_free("session-study", acting=(relaxing,))).replay
    together, one_by_one, cool = (
        replay.predict(World(acting=acting)) for acting in ((relaxing,), (relaxing, hardly), (hardly,))
    )
    assert len(replay._courses(World(acting=(relaxing, hardly)))) > len(replay._courses(World(acting=(relaxing,))))
    columns = [quantity.column for quantity in replay.quantities]
    for column in ("gas_pressure_pa", "current_2_a"):
        one = columns.index(column)
        warms = np.max(np.abs(together - cool)[:, one])
        np.testing.assert_allclose(one_by_one[:, one], together[:, one], rtol=0, atol=1e-3 * warms)


def test_repeats_long_after_each_other_are_rests_of_their_own() -> None:
    campaign = noise_free("session-study")
    dwell = next(run for run in campaign.runs if run.name == "dwell")
    gaps = np.diff(dwell.columns["time_s"])
    assert np.max(gaps) > LATER * np.median(gaps)
    evenly = replace(dwell, columns={**dwell.columns, "time_s": np.arange(len(dwell), dtype=float)})
    for run, rests in ((dwell, 6), (evenly, 1)):
        replay = linearised(replace(campaign, runs=(run,))).replay
        assert sum(len(segment) for segment in replay.segments) == rests
