"""How wide the prior is follows from data; where data do not tell that, intervals say so."""

from dataclasses import replace

import numpy as np

from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.quantities import quantities
from bench.record.campaign import Campaign, Run
from tests.identify.dynamics.rigid_world import Friction, N, arm, fourier, robot, torque_of

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.array([0.5, -1.0, 6.0]))


def one_way(rng: np.random.Generator, name: str) -> Run:
    """Return a run in which the elbow turns one way only, faster and slower."""
    time, q, velocity, acceleration = fourier(rng, rate=100.0)
    speed, swing, w = 0.15, 0.1, 2 * np.pi * 0.3
    q[:, 2] = speed * (time - time.mean()) + swing / w * np.sin(w * time)
    velocity[:, 2], acceleration[:, 2] = speed + swing * np.cos(w * time), -swing * w * np.sin(w * time)
    torque = torque_of(robot(arm()), q, velocity, acceleration) + FRICTION.torque(velocity)
    torque += rng.standard_normal(torque.shape)
    columns = {"time_s": time}
    columns |= {f"q_motor_{j + 1}_rad": q[:, j] for j in range(N)}
    columns |= {f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(N)}
    return Run(name, "motion", 0.0, columns)


def test_what_one_direction_does_not_tell_is_not_claimed() -> None:
    """Of a joint that turns one way, friction and offset are one number: neither is known to 1 % of its torque."""
    rng = np.random.default_rng(1)
    runs = tuple(replace(one_way(rng, f"run{k}"), start_s=100.0 * k) for k in range(3))
    found = first_pass(Campaign("rigid", runs), robot(arm(), mass=0.02, centre_of_mass_m=0.005), find_delay=False)
    told = {one.name: one for one in quantities(found)}
    quantile = found.quantile(0.9)
    for name, truth in (("torque offset (elbow)", 6.0), ("Coulomb friction (elbow)", 4.0)):
        low, high = told[name].interval(quantile)
        assert low <= truth <= high, (name, low, high)
    low, high = told["torque offset (shoulder)"].interval(quantile)
    assert low <= -1.0 <= high
    assert high - low < 3.0  # [Nm]: both directions tell it
