"""Small campaigns of the HH-150: two sweeps of joint 2 there and back, and loads at two poses."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import Experiment
from bench.scenario.loading import Loading
from bench.scenario.rotation import Rotation

Change = Callable[[dict[str, Array]], object]
SWEEPS = Rotation.model_validate(
    {
        "experiment": "rotation",
        "robot": "hh150",
        "joint": 2,
        "start_deg": (0, -20, 0, 0, 90, 0),
        "end_deg": 70,
        "speeds_deg_per_s": (10, 20),
        "ramp_s": 1.0,
        "sample_period_s": 0.04,
    }
)
SWEEP = SWEEPS.model_copy(update={"speeds_deg_per_s": (20.0,)})
LOADS = Loading.model_validate(
    {
        "experiment": "loading",
        "robot": "hh150",
        "poses": [
            {"q_deg": (0, 0, 0, 0, 60, 0), "force_n": (700, 1400)},
            {"q_deg": (20, 30, -30, 40, 60, 10), "force_n": (700, 1400)},
        ],
        "repeats": 3,
    }
)


def nominal() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


def made(
    session: Experiment,
    seed: int,
    hidden: Mapping[str, float] = {},
    without: tuple[str, ...] = (),
    machine: int | None = None,
    channels: tuple[str, ...] = (),
) -> Campaign:
    """Return a campaign with effects hidden, those of a joint in joint 2; of the machine with a seed, or of any."""
    robot = load_robot("hh150")
    compiled, effects = compile_robot(robot), catalogue()
    acting = []
    for name, value in hidden.items():
        places = effects[name].places(compiled)
        first = effects[name].parameters[0].name
        acting.append(Acting(effects[name], places[min(1, len(places) - 1)], effects[name].complete({first: value})))
    rng, own = np.random.default_rng(seed), None if machine is None else np.random.default_rng(machine)
    return hide_campaign(robot, session, acting, rng, without=without, channels=channels, machine=own).campaign


def changed(campaign: Campaign, change: Change) -> Campaign:
    """Return a campaign with the columns of every run changed in place."""
    runs = []
    for run in campaign.runs:
        columns = {name: np.array(values) for name, values in run.columns.items()}
        change(columns)
        runs.append(replace(run, columns=columns))
    return replace(campaign, runs=tuple(runs))


def scale(factor: float, *names: str) -> Change:
    return lambda columns: columns.update({name: factor * columns[name] for name in names})


def swap(one: str, two: str) -> Change:
    return lambda columns: columns.update({one: columns[two], two: columns[one]})


def freeze(name: str) -> Change:
    return lambda columns: columns.update({name: np.full_like(columns[name], columns[name][0])})


def in_motion(change: Change) -> Change:
    """Return what changes the runs in motion alone."""
    return lambda columns: change(columns) if "pose" not in columns else None
