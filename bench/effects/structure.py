"""Compliance of the structure between, across and below the drives."""

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Effect, Parameter, Place, Values
from bench.effects.geometry_at_zero import AtZero, across
from bench.effects.passive_hinges import add_hinges
from bench.effects.places import SHORT, OnDrive, drive_of, hinges
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot


class LinkBending(Effect):
    """A link is a beam."""

    name = "link_bending"
    family = "structure"
    title = "bending of a link"
    physics = (
        "A link of length L bends under the moment M in its middle by M L/(E I), lumped there in two hinges across the "
        "link: rotation = compliance x moment. Exact for the tip's rotation under a force, 3/4 of its share in the "
        "deflection."
    )
    source = (
        "De Luca and Book, Robots with flexible elements, Springer Handbook of Robotics, 2008; range: with castings of "
        "heavy arms as stiff as or stiffer than their gears, assumed"
    )
    parameters = (Parameter("compliance", "rad/Nm", 0.0, 1e-8, 4e-7, "L/(E I), about both axes across the link"),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the links between two driven joints that are not in one place."""
        model = compiled.model
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        found = []
        for i in range(compiled.n_joints - 1):
            first, second = compiled.at.joint[i : i + 2]
            long = np.linalg.norm(data.xanchor[second] - data.xanchor[first]) > SHORT
            if long and model.jnt_type[first] == mujoco.mjtJoint.mjJNT_HINGE:
                body = model.body(int(model.jnt_bodyid[first]))
                found.append(Place("body", int(body.id), str(body.name)))
        return tuple(found)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        compliance = values["compliance"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            zero = AtZero(spec)
            joints = [drive.joint for drive in robot.figures.drives]
            carried = [zero.body_of(joint) for joint in joints]
            i = carried.index(place.name)
            root, tip = zero.anchor(joints[i]), zero.anchor(joints[i + 1])
            beam = (tip - root) / np.linalg.norm(tip - root)
            add_hinges(
                spec,
                carried[i + 1],
                f"bending of {place.name}",
                (root + tip) / 2,
                across(beam),
                compliance,
                before=True,
            )

        return change if compliance else None


class BearingTilt(OnDrive):
    """The output bearing of a joint gives across its axis."""

    name = "bearing_tilt"
    family = "structure"
    title = "tilt of an output bearing"
    physics = (
        "The bearing of a joint tilts under the moment across its axis: rotation = compliance x moment, about both "
        "axes."
    )
    source = (
        "Abele, Weigold and Rothenbuecher, Modeling and identification of an industrial robot for machining "
        "applications, 2007; range: order of the moment rigidity that catalogues of RV gears state, assumed"
    )
    parameters = (Parameter("compliance", "rad/Nm", 0.0, 2e-8, 5e-7, "range for a drive of 10 kNm"),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives that turn a hinge."""
        return hinges(compiled)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        compliance = values["compliance"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            zero = AtZero(spec)
            joint = drive_of(robot, place).joint
            axes = across(zero.axis(joint))
            body = zero.body_of(joint)
            add_hinges(spec, body, f"tilt of {joint}", zero.anchor(joint), axes, compliance, before=False)

        return change if compliance else None


class _OfBase(Effect):
    family = "structure"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return (WHOLE,)


class BaseCompliance(_OfBase):
    """Foundation and anchor bolts give."""

    name = "base_compliance"
    title = "rocking of the base"
    physics = "The base rocks on its foundation about both horizontal axes: rotation = moment about the foot / k_base."
    source = (
        "design of this project: 5e6 to 1e8 Nm/rad; Dumas et al., Joint stiffness identification of six-revolute "
        "industrial serial robots, 2011"
    )
    parameters = (Parameter("compliance", "rad/Nm", 0.0, 1e-8, 2e-7, "1/k_base; k_base is 5e6 to 1e8 Nm/rad"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        compliance = values["compliance"]
        return _on_foot("base rocking", (0, 1), compliance) if compliance else None


class BaseTorsion(_OfBase):
    """Foundation and anchor bolts give about the vertical."""

    name = "base_torsion"
    title = "torsion of the base"
    physics = (
        "The base turns about the vertical under the moment about it; with a vertical first axis it adds to that "
        "joint's "
        "compliance and cannot be told from it where neither encoder nor tracker sees the base."
    )
    source = "as base_compliance"
    parameters = (Parameter("compliance", "rad/Nm", 0.0, 1e-8, 2e-7, "1/k_base about the vertical"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        compliance = values["compliance"]
        return _on_foot("base torsion", (2,), compliance) if compliance else None


def _on_foot(name: str, directions: tuple[int, ...], compliance: float) -> SpecEdit:
    def change(spec: mujoco.MjSpec, robot: Robot) -> None:
        zero = AtZero(spec)
        body = int(zero.model.joint(robot.figures.drives[0].joint).bodyid[0])
        root = zero.model.body(int(zero.model.body_rootid[body]))
        foot = np.array(zero.data.xpos[root.id])
        axes = [np.eye(3)[i] for i in directions]
        add_hinges(spec, str(root.name), name, foot, axes, compliance, before=True)

    return change
