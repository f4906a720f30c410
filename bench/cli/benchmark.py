"""`bench benchmark`: what the custom actuators cost."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Benchmark:
    """Step rate with the custom actuators against the same model without them, measured side by side in one run."""

    robot: str = "hh150"
    """Name of a robot folder, or a path to one."""

    def run(self) -> int:
        """Measure and print; return the exit code."""
        from bench.actuators.benchmark import step_rate_ratio
        from bench.robot.compiled import read_spec
        from bench.robot.folder import load_robot

        print(f"step rate with custom actuators / without: {step_rate_ratio(read_spec(load_robot(self.robot))):.3f}")
        return 0
