"""Recordings of one machine of the second plant: what lasts, what is another one, and how far both go."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import Nuisance, nuisances_of
from bench.diagnose.replay.quantities import Quantity
from bench.effects.drifts import BETWEEN, DAY_K, VISCOUS, own_shares
from bench.hide.second_plant import figures_of, run_second
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.session import SessionScenario
from bench.second.campaign import Second
from bench.second.figures import Figures
from bench.second.machine import Machine, Recorded, imperfect
from bench.second.worlds import World
from bench.study.labs import Lab

DAYS = ("A", "B")
MACHINES = 900
# Four standard deviations of what so many pairs say of a correlation, and of a standard deviation as a share of itself
CORRELATION, SPREAD = 4 / np.sqrt(MACHINES), 4 / np.sqrt(2 * MACHINES)

NAMES: dict[str, Callable[[Recorded], float]] = {
    "viscous friction of joint2": lambda one: one.figures.viscous[1] / nominal().viscous[1] - 1,
    "motor-side Coulomb friction of joint2": lambda one: one.figures.motor.level[1] / nominal().motor.level[1] - 1,
    "mass of column": lambda one: one.figures.lumps[0].mass / nominal().lumps[0].mass - 1,
    "weights that hang": lambda one: one.figures.hung_change,
    "weights bolted on": lambda one: one.figures.payload_change,
    "torque constant of joint2": lambda one: one.errors.current_gain[1],
    "current offset of joint2": lambda one: one.errors.current_offset[1],
    "gain of the force sensor": lambda one: one.errors.force_gain,
    "tilt of the force sensor, x": lambda one: one.errors.force_tilt[0],
    "tracker frame, shift x": lambda one: one.errors.frame_shift[0],
    "tracker frame, turn x": lambda one: one.errors.frame_rotation[0],
    "nest of reflector 1, x": lambda one: one.errors.placement[0, 0],
}


@cache
def compiled() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


@cache
def nominal() -> Figures:
    return figures_of(compiled())


def machine_with(seed: int) -> Machine:
    rng = np.random.default_rng([1, seed])
    return Machine(rng, own_shares(compiled().robot.figures), VISCOUS * DAY_K)


@cache
def drawn() -> dict[str, np.ndarray]:
    """Return what is wrong with many machines in two recordings each, shape (MACHINES, 2) by names of a diagnosis."""
    known = compiled().robot.figures
    pairs = [
        [imperfect(nominal(), known, np.random.default_rng([2, seed, day]), machine_with(seed)) for day in (0, 1)]
        for seed in range(MACHINES)
    ]
    return {name: np.array([[value(one) for one in pair] for pair in pairs]) for name, value in NAMES.items()}


@cache
def expected() -> tuple[Nuisance, ...]:
    columns = ("current_2_a", "force_x_n", "reflector_1_x_m")
    kinds, index = ("current", "force", "reflector"), (1, 0, 0)
    quantities = tuple(Quantity(*one, "", i) for *one, i in zip(columns, kinds, index, strict=True))
    return with_recordings(nuisances_of(compiled(), quantities), compiled(), DAYS)


@pytest.mark.parametrize("name", list(NAMES))
def test_errors_repeat_from_recording_to_recording_as_a_diagnosis_expects(name: str) -> None:
    pairs = drawn()[name]
    variance = {
        who: sum(n.sigma**2 for n in expected() if n.name == name and n.recording == who) for who in (None, "A")
    }
    total = sum(variance.values())
    assert np.sqrt(np.mean(pairs**2)) == pytest.approx(np.sqrt(total), rel=SPREAD)
    assert np.corrcoef(pairs.T)[0, 1] == pytest.approx(variance[None] / total, abs=CORRELATION)


def session() -> SessionScenario:
    """Return one pose, loaded."""
    whole = Lab().scenario().without("rotations", "line", "dwell", "repeat_at_end")
    assert whole.loading
    return whole.model_copy(update={"loading": whole.loading.model_copy(update={"poses": whole.loading.poses[:1]})})


def recording(machine: int | None, seed: int, without: tuple[str, ...] = ()) -> Second:
    source = None if machine is None else np.random.default_rng(machine)
    world = World(on_motors=1.0)
    return run_second(
        compiled().robot, session(), (), np.random.default_rng(seed), world=world, without=without, machine=source
    )


def test_a_machine_is_the_same_in_all_recordings_but_for_what_drifts_or_is_set_up_anew() -> None:
    first, second = (recording(7, seed).figures for seed in (1, 2))
    for part, names in (
        ("springs", ("stiffness",)),
        ("motor", ("level", "stiffness")),
        ("link", ("level", "stiffness")),
        ("gas", ("constant", "critical_length", "rho", "b")),
    ):
        for name in names:
            one, other = (getattr(getattr(figures, part), name) for figures in (first, second))
            assert np.array_equal(one, other), f"{part}.{name} lasts"
    assert np.array_equal(first.position, second.position)
    assert np.array_equal(first.rotor_inertia, second.rotor_inertia)
    assert first.hung_change == second.hung_change
    assert [lump.mass for lump in first.lumps] == [lump.mass for lump in second.lumps]
    assert first.payload_change != second.payload_change
    assert np.all(first.viscous != second.viscous)


def test_another_machine_is_another_one() -> None:
    first, second = (recording(machine, 1).figures for machine in (7, 8))
    assert not np.any(first.springs.stiffness == second.springs.stiffness)


def test_a_recording_repeats_with_its_seed_and_has_a_day_of_its_own() -> None:
    first, same, other = (recording(7, seed).campaign.runs[0].columns for seed in (1, 1, 2))
    assert all(np.array_equal(first[name], same[name]) for name in first)
    for name in ("current_2_a", "reflector_1_x_m", "force_x_n", "gear_temperature_1_k", "ambient_temperature_k"):
        assert not np.array_equal(first[name], other[name]), name


def test_what_the_lab_has_not_is_not_recorded() -> None:
    there, columns = (recording(7, 1, without).campaign.runs[0].columns for without in ((), ("tracker", "pressure")))
    gone = {name for name in there if name.startswith(("reflector", "gas"))}
    assert gone
    assert set(there) - set(columns) == gone
    whole = Lab().scenario().without("rotations", "loading", "repeat_at_end")
    brief = run_second(compiled().robot, whole, (), np.random.default_rng(1), quiet=True, without=("line",))
    assert [run.name for run in brief.campaign.runs] == ["dwell"]


def test_every_error_of_an_instrument_says_what_becomes_of_it() -> None:
    errors = imperfect(nominal(), compiled().robot.figures, np.random.default_rng(1)).errors
    assert set(vars(errors)) <= set(BETWEEN)
