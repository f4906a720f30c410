"""`bench robots`: the robots that come along."""

from dataclasses import dataclass
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Robots:
    """List robots: joints, instruments, counterbalance, and what was fitted to measured data."""

    robots: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    """Names, or folders of your own; by default those that come along."""

    def run(self) -> int:
        """Print; return the exit code."""
        from bench.robot.folder import load_robot, robot_names

        for name in self.robots or robot_names():
            figures = load_robot(name).figures
            fitted = [key for key, instrument in figures.instruments if instrument is not None]
            print(f"{name}: {figures.title}")
            print(f"  joints          {', '.join(drive.joint for drive in figures.drives)}")
            print(f"  instruments     {', '.join(key.replace('_', ' ') for key in fitted) or 'none'}")
            print(f"  counterbalance  {f'on {figures.counterbalance.joint}' if figures.counterbalance else 'none'}")
            if figures.fitted.is_given:
                print(f"  fitted          {', '.join(figures.fitted.words())}")
        return 0
