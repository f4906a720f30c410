"""Makes the numbers of the example in bench/record/README.md: `python -m tests.record.page_example`.

The nominal HH-150 with a tool of 20 kg at rest in one pose, by equilibrium, read by its instruments.
"""

import numpy as np

from bench.record.campaign import Array, Run
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.simulate.payload import bolt_on
from bench.simulate.policy import Mark, Step
from bench.simulate.quasistatic import RestLog

POSE = np.array([0, 0.5, -0.3, 0, 0.8, 0])  # [rad]
APPROACH = np.deg2rad(3)  # [rad] of each joint from below, so that friction has one sign
TOOL_KG, HUNG_N = 20.0, -980.665  # 100 kg hang
SEED = 1  # of the instruments; any other gives as good an example
COLUMNS = {"current_2_a": 2, "reflector_1_x_m": 6, "reflector_1_y_m": 6, "reflector_1_z_m": 6}  # decimals


def readings(rng: np.random.Generator | None = None) -> Run:
    """Return two readings without load and two with; of ideal instruments if no generator is given."""
    steps = [Step(POSE - APPROACH, np.zeros(6))]
    for load_step in (0, 1):
        wrench = np.array([0, 0, HUNG_N * load_step, 0, 0, 0])
        for repeat in (1, 2):
            labels = {"pose": 1, "approach": 1, "load_step": load_step, "repeat": repeat}
            steps.append(Step(POSE, wrench, Mark("loading", labels)))
    return _log(steps).read(rng).runs[0]


def pressure(pose: Array) -> float:
    """Return the pressure of the gas at rest in a pose [Pa]."""
    run = _log([Step(pose, np.zeros(6), Mark("rest", {"pose": 1, "load_step": 0, "repeat": 1}))]).read(None).runs[0]
    return float(run.columns["gas_pressure_pa"][0])


def _log(steps: list[Step]) -> RestLog:
    compiled = compile_robot(load_robot("hh150"), [bolt_on(TOOL_KG)])
    return RestLog(compiled, steps, steps[0].q_cmd)


def main() -> None:
    """Print the table, and what the lab knows besides."""
    columns = readings(np.random.default_rng(SEED)).columns
    names = ["pose", "approach", "load_step", "repeat", *(f"q_cmd_{j}_rad" for j in range(1, 7)), "load_z_n", *COLUMNS]
    print(",".join(names))
    for row in range(len(columns["pose"])):
        print(
            ",".join(
                f"{columns[n][row]:.{COLUMNS[n]}f}" if n in COLUMNS else f"{columns[n][row] + 0.0:g}" for n in names
            )
        )  # -0 is 0
    compiled = compile_robot(load_robot("hh150"))
    print(f"stiffness of joint 2: {compiled.stiffness[1]:g} Nm/rad; pressure at zero: {pressure(np.zeros(6)):.4g} Pa")


if __name__ == "__main__":
    main()
