"""Two recordings of one small machine: sweeps of joint 2 and loads at two poses, for tests of comparisons."""

from collections.abc import Mapping

import numpy as np

from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import Experiment


def recorded(session: Experiment, machine: int, day: int, hidden: Mapping[str, float] = {}) -> Campaign:
    """Return a recording of the machine with a seed on a day, with effects hidden, those of a joint in joint 2."""
    robot = load_robot("hh150")
    compiled, effects = compile_robot(robot), catalogue()
    acting = []
    for name, value in hidden.items():
        places = effects[name].places(compiled)
        first = effects[name].parameters[0].name
        acting.append(Acting(effects[name], places[min(1, len(places) - 1)], effects[name].complete({first: value})))
    rng, own = np.random.default_rng(day), np.random.default_rng(machine)
    return hide_campaign(robot, session, acting, rng, machine=own).campaign
