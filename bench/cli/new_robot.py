"""`bench new-robot`: a robot folder from an MJCF or URDF."""

import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

SHOWN = 300  # characters of what was left out


@dataclass(frozen=True)
class NewRobot:
    """Start a robot folder from an MJCF or URDF, adding rotors, elastic elements, servos, instruments with defaults."""

    name: tyro.conf.Positional[str]
    """Name of the robot; its files are named after it."""
    mjcf: Path
    """MJCF or URDF of the arm, with its meshes where the file says."""
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Folder to write; must not exist yet. Default: the robot's name, here."""
    joints: tuple[str, ...] = ()
    """Driven joints from the base to the tool; default: all up to where the arm branches, so without a gripper."""
    load_point: str = ""
    """Where loads act: a site, or a link whose frame lies there (a URDF has no sites), behind the last driven joint.
    Default: a site with a usual name on the last link, else the end of the chain."""
    reflectors: tuple[str, ...] = ()
    """Where the tracker's reflectors are: sites or links likewise, the reference point first. Default: one, in the
    load point."""

    def run(self) -> int:
        """Write the folder and say what is in it; return the exit code."""
        from bench.robot.starter.folder import start_robot
        from bench.robot.starter.source import read_source

        folder = self.out or Path(self.name)
        started = start_robot(self.name, read_source(self.mjcf, self.joints, self.load_point, self.reflectors), folder)
        print(f"{folder}: {len(started.drives)} drives: {', '.join(joint.name for joint in started.source.joints)}")
        print(f"load point: {started.source.load_point.origin}")
        for k, place in enumerate(started.source.reflectors, start=1):
            print(f"reflector {k}: {place.origin}")
        if started.source.left_out:
            left_out = ", ".join(started.source.left_out)
            print(f"left out: {textwrap.shorten(left_out, SHOWN, placeholder=' ... (all of it in README.md)')}")
        for sentence in started.source.lost_balance:
            print(sentence)
        for line in started.compiled.robot.figures.assumed:
            print(f"assumed {line}")
        print(f"{folder / 'README.md'} says where every figure comes from; replace what you know better.")
        return 0
