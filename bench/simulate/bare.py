"""A model without what physics does not need: nothing to look at, and no sensors of its own. A quarter faster."""

import mujoco

from bench.robot.compiled import read_spec
from bench.robot.folder import Robot


def bare_spec(robot: Robot) -> mujoco.MjSpec:
    """Return the MJCF of a robot without shapes that touch nothing and weigh nothing, cameras, and its own sensors.

    A shape stays where it collides, or where the mass of its body comes from the shapes. To read and to strip the file
    takes ten times as long as to copy and to compile the result: who compiles often, keeps it.

    Raises:
        RobotError: The file is not valid MJCF.
    """
    spec = read_spec(robot)
    if spec.compiler.inertiafromgeom != mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE:
        for geom in list(spec.geoms):
            if geom.contype == 0 and geom.conaffinity == 0 and geom.parent.explicitinertial:
                spec.delete(geom)
    for part in (*spec.cameras, *spec.sensors):
        spec.delete(part)
    return spec
