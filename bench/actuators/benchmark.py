"""What the actuators cost: the step rate of a model with them against the same model without, side by side in one run.

Run it as `python -m bench.actuators.benchmark models/<robot>/<robot>.xml`.
"""

import sys
from time import perf_counter

import mujoco

_STEPS = 500  # per timed block; each block starts from a reset
_ROUNDS = 100  # the two models take turns, so that a slow spell of the machine hits both


def step_rate_ratio(spec: mujoco.MjSpec, rounds: int = _ROUNDS) -> float:
    """Return the rate of `mj_step` with the actuators of this package relative to the rate with them deleted.

    Each rate is that of the fastest block, which other work on the machine disturbed least.

    Args:
        spec: Model to measure; it is left as it is.
        rounds: Number of timed blocks of each model.
    """
    bare = spec.copy()
    for actuator in [actuator for actuator in bare.actuators if actuator.plugin.active]:
        bare.delete(actuator)
    for shared in [plugin for plugin in bare.plugins if plugin.name]:
        bare.delete(shared)
    models = spec.compile(), bare.compile()
    data = [mujoco.MjData(model) for model in models]
    fastest = [float("inf"), float("inf")]  # [s]
    for turn in range(rounds):
        for i in (turn % 2, 1 - turn % 2):
            mujoco.mj_resetData(models[i], data[i])
            start = perf_counter()
            mujoco.mj_step(models[i], data[i], _STEPS)
            fastest[i] = min(fastest[i], perf_counter() - start)
    return fastest[1] / fastest[0]


if __name__ == "__main__":
    for path in sys.argv[1:]:
        print(f"{path}: step rate with actuators / without: {step_rate_ratio(mujoco.MjSpec.from_file(path)):.3f}")
