"""`bench robots`: the robots that come along."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Robots:
    """List the robot folders that come along: joints, instruments, counterbalance."""

    def run(self) -> int:
        """Print; return the exit code."""
        from bench.robot.folder import load_robot, robot_names

        for name in robot_names():
            figures = load_robot(name).figures
            fitted = [key for key, instrument in figures.instruments if instrument is not None]
            print(f"{name}: {figures.title}")
            print(f"  joints          {', '.join(drive.joint for drive in figures.drives)}")
            print(f"  instruments     {', '.join(key.replace('_', ' ') for key in fitted) or 'none'}")
            print(f"  counterbalance  {f'on {figures.counterbalance.joint}' if figures.counterbalance else 'none'}")
        return 0
