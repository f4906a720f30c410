"""The robot as somebody applies it: with everything that its folder holds as fitted, carrying a known payload."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.diagnose.replay.fitted import fitted_world
from bench.diagnose.replay.world import World, edits_in
from bench.effects.conditions import Conditions
from bench.report.handover.drag import drag_of
from bench.robot.bodies import RigidBodies
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot, compile_spec, read_spec
from bench.robot.folder import Robot
from bench.robot.links import rigid_bodies


@dataclass(frozen=True, eq=False)
class Applied:
    """A robot at the temperatures for which its figures hold.

    Attributes:
        compiled: With the payload, and with the effects that `figures.yaml` holds beside the MJCF.
        spec: What it was compiled of.
        bodies: Its links as rigid bodies; what hangs on a passive hinge belongs to the link that carries it.
        passive: Names of the joints that no drive moves, which `bodies` leaves out.
        world: What `figures.yaml` holds as fitted.
        conditions: Temperatures and payload.
    """

    compiled: CompiledRobot
    spec: mujoco.MjSpec
    bodies: RigidBodies
    passive: tuple[str, ...]
    world: World
    conditions: Conditions

    @property
    def is_without_friction(self) -> bool:
        """Whether no drive has any: of no friction drive, or fitted to torques of sensors behind the gears."""
        levels = (self.compiled.motor_coulomb, self.compiled.link_coulomb, self.compiled.motor_rolling)
        return not (any(map(np.any, levels)) or np.any(drag_of(self.compiled)))


def applied_robot(robot: Robot, payload_kg: float = 0.0) -> Applied:
    """Return a robot with a point mass bolted to its load point [kg].

    Raises:
        RobotError: The robot does not compile, or its links are no tree of driven joints.
    """
    compiled = compile_robot(robot)
    world, conditions = fitted_world(compiled), Conditions.reference(compiled.n_joints, payload_kg)
    edits = edits_in(world, conditions)
    spec = read_spec(robot)
    changed = compile_spec(spec, robot, edits)
    moved = {changed.model.joint(int(j)).name for j in changed.model.dof_jntid[changed.at.q_dof]}
    moved |= {drive.joint for drive in robot.figures.drives}
    names = [str(changed.model.joint(j).name) for j in range(changed.model.njnt)]
    passive = tuple(name for name in names if name not in moved)
    stiff = compile_robot(robot, [*edits, _without(passive)]) if passive else changed
    return Applied(changed, spec, rigid_bodies(stiff), passive, world, conditions)


def _without(joints: tuple[str, ...]) -> SpecEdit:
    def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
        for key in list(spec.keys):  # of another size
            spec.delete(key)
        for name in joints:
            spec.delete(spec.joint(name))

    return edit
