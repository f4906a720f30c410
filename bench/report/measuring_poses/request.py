"""What somebody asks for who wants measuring poses. Imports nothing heavy, so that the command line can show it."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class PoseRequest:
    """Which poses are wanted, and which can be had."""

    robot: str
    """Name of a robot folder, or a path to one."""
    count: int = 6
    """Number of poses."""
    method: Literal["current", "force"] = "current"
    """Method of identification that the poses are for."""
    slanting: int = 2
    """Number of poses at which the load may slant; a hanging load does not show an axis that is vertical."""
    slant_deg: float = 45.0
    """Angle between a slanting load and the vertical."""
    against: str | None = None
    """Loading scenario to compare with, by name or path; left out where it is for another robot."""
    after: str | None = None
    """Loading scenario whose poses have been measured already, so that the new ones complement them."""
    margin_deg: float = 5.0
    """Distance to the joint limits."""
    floor_m: float = 0.3
    """Height above the base's origin that joints, load point and reference point keep."""
    clearance_m: float = 0.8
    """Horizontal distance of load point and reference point from the vertical line through the base."""
    hanging_height_m: float = 0.8
    """Height of the load point that a hanging load needs."""
    rope_clearance_m: float = 0.1
    """Horizontal distance of the rope of a hanging load from every joint below the load point."""
    zone_limit: float = 0.05
    """Largest relative error of a stiffness that leaving out K_C may cause under the rated load (Fig. 6)."""
    seed: int = 0
    """Of the candidates; the same seed gives the same poses."""
