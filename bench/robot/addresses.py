"""Where the parts that a robot's figures name sit in its compiled model."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.errors import RobotError, unknown_name
from bench.robot.folder import Robot

Index = NDArray[np.int64]


@dataclass(frozen=True)
class Addresses:
    """Where the parts named in the figures sit in the compiled model; arrays have one entry per drive.

    Attributes:
        joint: Joint ids of the links (theta).
        theta, theta_dof: Entries of qpos and qvel of the link joints.
        q, q_dof: Entries of qpos and qvel of the rotors.
        element: Tendon ids of the elastic elements.
        servo: Actuator ids; `servo_ctrl` their first control entry (position set point; the next is the velocity).
        motor_friction, link_friction: Actuator ids of the friction elements.
        load_body: Body id on which wrenches act.
        load_point: Site id.
        reflectors: Site ids.
        counterbalance, counterbalance_tendon: Actuator and tendon id, -1 for a robot without one.
    """

    joint: Index
    theta: Index
    theta_dof: Index
    q: Index
    q_dof: Index
    element: Index
    servo: Index
    servo_ctrl: Index
    motor_friction: Index
    link_friction: Index
    load_body: int
    load_point: int
    reflectors: Index
    counterbalance: int
    counterbalance_tendon: int


def addresses_of(robot: Robot, model: mujoco.MjModel) -> Addresses:
    """Return where the parts that the figures name sit in a model.

    Raises:
        RobotError: The model lacks parts; every missing one is listed.
    """
    problems: list[str] = []

    def find(kind: str, name: str | None, place: str) -> int:
        if name is None:
            return -1
        element = getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}")
        index = mujoco.mj_name2id(model, element, name)
        if index < 0:
            count = {"joint": model.njnt, "tendon": model.ntendon, "actuator": model.nactuator}
            count |= {"site": model.nsite, "body": model.nbody}
            known = (mujoco.mj_id2name(model, element, i) for i in range(count[kind]))
            what = unknown_name(f"{kind} of {robot.mjcf.name}", name, filter(None, known))
            problems.append(f"{robot.figures_file}: {place}: {what}")
        return int(index)

    figures = robot.figures
    drives = list(enumerate(figures.drives))
    joint = np.array([find("joint", d.joint, f"drives[{i}].joint") for i, d in drives])
    rotor = np.array([find("joint", d.rotor, f"drives[{i}].rotor") for i, d in drives])
    element = np.array([find("tendon", d.element, f"drives[{i}].element") for i, d in drives])
    servo = np.array([find("actuator", d.servo, f"drives[{i}].servo") for i, d in drives])
    motor_friction = np.array([find("actuator", d.motor_friction, f"drives[{i}].motor_friction") for i, d in drives])
    link_friction = np.array([find("actuator", d.link_friction, f"drives[{i}].link_friction") for i, d in drives])
    sites = [find("site", name, f"reflectors[{i}]") for i, name in enumerate(figures.reflectors)]
    load_body = find("body", figures.load_body, "load_body")
    load_point = find("site", figures.load_point, "load_point")
    balance = figures.counterbalance
    balance_actuator = find("actuator", balance.actuator if balance else None, "counterbalance.actuator")
    balance_tendon = find("tendon", balance.tendon if balance else None, "counterbalance.tendon")
    if problems:
        raise RobotError(problems)
    return Addresses(
        joint=joint,
        theta=model.jnt_qposadr[joint].astype(np.int64),
        theta_dof=model.jnt_dofadr[joint].astype(np.int64),
        q=model.jnt_qposadr[rotor].astype(np.int64),
        q_dof=model.jnt_dofadr[rotor].astype(np.int64),
        element=element,
        servo=servo,
        servo_ctrl=model.actuator_ctrladr[servo].astype(np.int64),
        motor_friction=motor_friction,
        link_friction=link_friction,
        load_body=load_body,
        load_point=load_point,
        reflectors=np.array(sites, dtype=np.int64),
        counterbalance=balance_actuator,
        counterbalance_tendon=balance_tendon,
    )
