"""From a robot folder to a compiled MuJoCo model, with every address looked up once."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.errors import RobotError, unknown_name
from bench.robot.addresses import Addresses, addresses_of
from bench.robot.checks import faulty_roles, negative_masses, unlike_a_robot, unlike_errors, unlike_friction
from bench.robot.counterbalance import Counterbalance
from bench.robot.folder import Robot
from bench.robot.hindrances import friction_holds, hindrances, uncounted
from bench.robot.plain_words import plain_words
from bench.robot.plugins import attributes_of, number_of, numbers_of
from bench.robot.trial import expect_harmless

FRICTION = ("coulomb", "presliding_stiffness")  # attributes of a friction element
SAME_PLACE = 1e-9  # [m]
IN_PLANE = 2e-3  # [m]; anchors this far out of one plane change the counterbalance's length by less than 1e-5 of it
SpecEdit = Callable[[mujoco.MjSpec, Robot], None]


@dataclass(frozen=True)
class CompiledRobot:
    """A robot, its compiled model, and the addresses of its parts. The model is not to be changed.

    Attributes:
        robot: The folder it came from.
        model: Compiled MjModel.
        at: Addresses in the model.
        motor_coulomb, link_coulomb: Shape (n,) [Nm], Coulomb levels of the friction elements.
        motor_presliding, link_presliding: Shape (n,) [Nm/rad], stiffness of the friction elements while they hold.
        motor_rolling: Shape (n,) [Nm], rolling friction of the motor side at 1 rad/s (1 m/s).
        motor_drag: Shape (n,) [Nm s/rad] or [N s/m], of learned friction of the motor side, its linear part.
        motor_rise, link_rise: Shape (n,), by which share the friction elements hold more at standstill.
        motor_stribeck, link_stribeck: Shape (n,) [rad/s] or [m/s], at which 1/e of that is left; 0 where there is none.
        counterbalance: Closed form of the counterbalance with the anchors and gas figures of the MJCF; None where there
            is none, and where its `gas_amount` is 0.
    """

    robot: Robot
    model: mujoco.MjModel
    at: Addresses
    motor_coulomb: NDArray[np.float64]
    link_coulomb: NDArray[np.float64]
    motor_presliding: NDArray[np.float64]
    link_presliding: NDArray[np.float64]
    motor_rolling: NDArray[np.float64]
    motor_drag: NDArray[np.float64]
    motor_rise: NDArray[np.float64]
    link_rise: NDArray[np.float64]
    motor_stribeck: NDArray[np.float64]
    link_stribeck: NDArray[np.float64]
    counterbalance: Counterbalance | None

    @property
    def n_joints(self) -> int:
        """Number of driven joints."""
        return self.robot.n_joints

    @property
    def torque_constant(self) -> NDArray[np.float64]:
        """Shape (n,) [Nm/A]; xi of Table 2."""
        return np.array([drive.torque_constant_nm_per_a for drive in self.robot.figures.drives])

    @property
    def stiffness(self) -> NDArray[np.float64]:
        """Shape (n,) [Nm/rad]; linear stiffness of the elastic elements."""
        return np.array(self.model.tendon_stiffness[self.at.element])

    @property
    def damping(self) -> NDArray[np.float64]:
        """Shape (n,) [Nm s/rad]; linear damping of the elastic elements, which acts within their play as well."""
        return np.array(self.model.tendon_damping[self.at.element])

    @property
    def play(self) -> NDArray[np.float64]:
        """Shape (n,) [rad] or [m]; within which the elastic elements transmit nothing."""
        rest = self.model.tendon_lengthspring[self.at.element]
        return np.array(rest[:, 1] - rest[:, 0])

    @property
    def has_plain_elements(self) -> bool:
        """Whether each elastic element is a linear spring between one rotor and one link, with nothing beside it.

        What pulls on a rotor and a link at once, along the element or another tendon, is beside it.
        """
        model, element = self.model, self.at.element
        rest = model.tendon_lengthspring[element]
        acted_on = model.actuator_trnid[model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON, 0]
        return not (
            np.any(model.tendon_stiffnesspoly[element])
            or np.any(rest[:, 0] != rest[:, 1])
            or np.any(model.tendon_plasticadr[element] >= 0)
            or np.any(model.tendon_num[element] != 2)
            or any(self._joins(tendon) for tendon in acted_on.tolist())
        )

    def _joins(self, tendon: int) -> bool:
        """Whether a tendon runs over a rotor and a link."""
        model, start = self.model, int(self.model.tendon_adr[tendon])
        along = slice(start, start + int(model.tendon_num[tendon]))
        joints = model.wrap_objid[along][model.wrap_type[along] == mujoco.mjtWrap.mjWRAP_JOINT]
        dofs = model.jnt_dofadr[joints]
        return bool(np.any(np.isin(dofs, self.at.theta_dof)) and np.any(np.isin(dofs, self.at.q_dof)))

    @property
    def is_slide(self) -> tuple[bool, ...]:
        """Which driven joints are slides; the others are hinges."""
        return tuple(bool(kind == mujoco.mjtJoint.mjJNT_SLIDE) for kind in self.model.jnt_type[self.at.joint])

    @property
    def limits(self) -> NDArray[np.float64]:
        """Shape (n, 2) [rad]; range of the link joints."""
        return np.array(self.model.jnt_range[self.at.joint])


def read_spec(robot: Robot) -> mujoco.MjSpec:
    """Return the MJCF of a robot as an editable `MjSpec`, without what it does not carry.

    Raises:
        RobotError: The file is not valid MJCF, MuJoCo's own message is kept; or it does not pass `expect_harmless`.
    """
    expect_harmless(robot.mjcf)
    try:
        spec = mujoco.MjSpec.from_file(str(robot.mjcf))
    except ValueError as error:
        raise RobotError(f"{robot.mjcf}: {plain_words(error)}") from error
    for name in robot.not_carried:
        spec.delete(spec.body(name))
    return spec


def compile_robot(robot: Robot, edits: Iterable[SpecEdit] = (), timestep: float | None = None) -> CompiledRobot:
    """Compile a robot after applying `edits` to its spec, in order.

    Raises:
        RobotError: The MJCF does not compile, lacks a part that the figures name, or a part does not play its role;
            every missing or misplaced part is listed. Or it is what no arm is.
    """
    compiled = compile_spec(read_spec(robot), robot, edits, timestep)
    coulomb = compiled.motor_coulomb + compiled.link_coulomb
    elements = {
        "motor": (compiled.motor_coulomb, compiled.motor_presliding),
        "link": (compiled.link_coulomb, compiled.link_presliding),
    }
    if faults := (
        *unlike_a_robot(robot, compiled.model),
        *hindrances(robot, compiled.model),
        *((*friction_holds(robot, compiled.model, coulomb), *uncounted(robot, compiled.model)) if not edits else ()),
        *(unlike_friction(robot, compiled.model, elements) if not edits else ()),
        *unlike_errors(robot, compiled.model),
    ):
        raise RobotError(faults)
    return compiled


def compile_spec(
    spec: mujoco.MjSpec, robot: Robot, edits: Iterable[SpecEdit] = (), timestep: float | None = None
) -> CompiledRobot:
    """Compile a spec of a robot after applying `edits` to it, in order; the spec is changed.

    Raises:
        RobotError: As `compile_robot`.
    """
    for edit in edits:
        edit(spec, robot)
    if timestep is not None:
        spec.option.timestep = timestep
    if negative := tuple(negative_masses(robot, spec)):
        raise RobotError(negative)
    try:
        model = spec.compile()
        drawn = mujoco.MjData(model)  # plugins look at their figures only now
    except ValueError as error:
        raise RobotError(f"{robot.mjcf}: {plain_words(error)}") from error
    at = addresses_of(robot, model)
    if problems := tuple(faulty_roles(robot, model)):
        raise RobotError(problems)
    mujoco.mj_kinematics(model, drawn)
    check_load_body(robot, drawn, at)
    elements = {
        side: [getattr(drive, f"{side}_friction") for drive in robot.figures.drives] for side in ("motor", "link")
    }
    motor, link = (np.array(numbers_of(spec, names, FRICTION)).T for names in elements.values())

    def shape(side: str, attribute: str) -> NDArray[np.float64]:
        return np.array([float(attributes_of(spec, name).get(attribute, "0")) for name in elements[side]])

    return CompiledRobot(
        robot=robot,
        model=model,
        at=at,
        motor_coulomb=motor[0],
        link_coulomb=link[0],
        motor_presliding=motor[1],
        link_presliding=link[1],
        motor_rolling=np.array([rolling_of(attributes_of(spec, name)) for name in elements["motor"]]),
        motor_drag=shape("motor", "drag"),
        motor_rise=shape("motor", "static_rise"),
        link_rise=shape("link", "static_rise"),
        motor_stribeck=shape("motor", "stribeck_velocity"),
        link_stribeck=shape("link", "stribeck_velocity"),
        counterbalance=counterbalance_of(robot, spec, model, drawn, at),
    )


def rolling_of(attributes: Mapping[str, str]) -> float:
    """Return the rolling friction of a friction element from its attributes, 0 where it has none [Nm]."""
    return float(attributes.get("rolling", "0"))


def check_load_body(robot: Robot, data: mujoco.MjData, at: Addresses) -> None:
    """Check that the centre of mass of the load body, where wrenches act, is in the load point; `data` has kinematics.

    Raises:
        RobotError: It is elsewhere.
    """
    if np.linalg.norm(data.xipos[at.load_body] - data.site_xpos[at.load_point]) > SAME_PLACE:
        name, site = robot.figures.load_body, robot.figures.load_point
        raise RobotError(
            f"{robot.mjcf}: body {name!r} must have its centre of mass at site {site!r}; put it there and give it "
            '<inertial pos="0 0 0" mass="0" diaginertia="0 0 0"/> (without it MuJoCo puts the centre elsewhere).'
        )


def counterbalance_of(
    robot: Robot, spec: mujoco.MjSpec, model: mujoco.MjModel, data: mujoco.MjData, at: Addresses
) -> Counterbalance | None:
    """Return the closed form of the counterbalance: anchors from the tendon, gas figures from the actuator.

    `data` has kinematics with all joints at zero. None where `CompiledRobot.counterbalance` is.

    Raises:
        RobotError: The figures name no driven joint, or the tendon does not run in a plane across the joint.
    """
    named = robot.figures.counterbalance
    if named is None:
        return None
    joints = [drive.joint for drive in robot.figures.drives]
    if named.joint not in joints:
        raise RobotError(
            f"{robot.figures_file}: counterbalance.joint: {unknown_name('driven joint', named.joint, joints)}"
        )
    index = joints.index(named.joint)
    joint = at.joint[index]
    axis, pivot = data.xaxis[joint], data.xanchor[joint]
    start = model.tendon_adr[at.counterbalance_tendon]
    arms = data.site_xpos[model.wrap_objid[start : start + 2]] - pivot
    heights = arms @ axis
    if abs(heights[0] - heights[1]) > IN_PLANE:
        raise RobotError(
            f"{robot.mjcf}: the anchors of tendon {named.tendon!r} must lie in one plane across {named.joint!r}."
        )
    fixed, moving = arms - np.outer(heights, axis)
    from_fixed_to_moving = np.arctan2(axis @ np.cross(fixed, moving), fixed @ moving)
    given = attributes_of(spec, named.actuator)
    amount = float(given.get("gas_amount", 1.0))
    if amount == 0:  # anchors and figures are there, the gas is not: it pulls at nothing until someone fills it
        return None
    return Counterbalance(
        joint=index,
        rho=float(np.linalg.norm(fixed)),
        b=float(np.linalg.norm(moving)),
        dead_centre=float(-from_fixed_to_moving),
        gas_constant=amount * number_of(spec, named.actuator, "constant"),
        critical_length=number_of(spec, named.actuator, "critical_length"),
        exponent=float(given.get("exponent", 1.0)),
        reference_length=float(given.get("reference_length", 0.0)),
        seal_friction=float(given.get("seal_friction", 0.0)),
        relaxation_time=float(given.get("relaxation_time", np.inf)),
        heat_capacity_ratio=float(given.get("heat_capacity_ratio", 1.0)),
    )
