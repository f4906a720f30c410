"""A payload as a change of the model: a point mass bolted to the load point."""

import mujoco

from bench.robot.compiled import SpecEdit
from bench.robot.folder import Robot


def bolt_on(mass_kg: float) -> SpecEdit:
    """Return the edit that gives the load body a mass [kg] in the load point; its own inertia is left out."""

    def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
        spec.body(robot.figures.load_body).mass = mass_kg

    return edit
