"""`bench benchmark`: what the custom actuators cost."""

from dataclasses import dataclass

import tyro


@dataclass(frozen=True)
class Benchmark:
    """Step rate with the custom actuators against the same model without them, measured side by side in one run."""

    robots: tyro.conf.Positional[tuple[str, ...]] = ()
    """Names of robot folders, or paths to them; none: all that come along."""

    def run(self) -> int:
        """Measure and print; return the exit code."""
        from bench.actuators.benchmark import step_rate_ratio
        from bench.robot.compiled import read_spec
        from bench.robot.folder import load_robot, robot_names

        for name in self.robots or robot_names():
            ratio = step_rate_ratio(read_spec(load_robot(name)))
            print(f"{name}: step rate with custom actuators / without: {ratio:.3f}")
        return 0
