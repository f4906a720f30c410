"""Every number of hh150.xml, given or derived, and a check that the file holds it.

    python derive.py            print the tables of README.md
    python derive.py --check    compare hh150.xml and README.md with them; exit code 1 names every difference

Needs NumPy only. The arm itself (kinematics, masses, what the paper gives) stands in arm.py.
"""

import json
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path

import arm
import numpy as np
from arm import DEG, PARTS, STIFFNESS, Array

HERE = Path(__file__).parent

# Reconstructed: static friction in the unloaded rows of Table 5, see paper/README.md
UNLOADED_CURRENT = np.array([0.2, 2.0, 2.0, 0.85, 1.6, 0.2])  # [A]

# Assumed
ROTOR_INERTIA = np.array([9.23, 11.8, 11.8, 1.73, 1.73, 1.73]) * 1e-3  # [kg m^2] published for a KUKA KR300 R2500
GEAR_RATIO = np.array([256.857143, 267.428571, 252.333333, 221, 239.619048, 154.323134])  # the same source
SPEED_LIMIT = np.array([100, 100, 100, 140, 110, 180]) * DEG  # [rad/s] class of the KR300
LINK_SHARE = 0.30  # of the static friction acts behind the elastic element
VISCOUS_SPEED = 0.5  # [rad/s] at which viscous friction equals the static level
PRESLIDING = 1e-5  # [rad] after which a friction element slips, where the time step allows it
COARSEST_STEP, STEP_RULE = 1e-3, 0.7  # [s], [-]: sqrt(sigma / J) * dt stays below the rule at the coarsest step
ELEMENT_DAMPING = 0.05  # [-] damping ratio of each elastic element with what hangs on it at home, rotor held
BANDWIDTH = 2 * np.pi * 20.0  # [rad/s] of the servo on the bare rotor, damping ratio 1
RESET_TIME = 0.5  # [s] in which the integral action takes over 63 % of what stuck friction carries
ACCELERATION_TIME = 0.5  # [s] from rest to the speed limit, for the torque limit
HOME = np.array([0, 0, 0, 0, 90, 0]) * DEG  # [rad] upper arm vertical, forearm horizontal, tool down
PAYLOAD = 150.0  # [kg] at the load point, for the stability of the servo
STEP_SIZE = 1e-3  # [s] of hh150.xml, see README.md for the convergence study


@dataclass(frozen=True)
class Number:
    """One attribute of hh150.xml.

    Attributes:
        path: XPath of the element.
        attribute: Name of the attribute.
        value: What it has to hold, any shape.
    """

    path: str
    attribute: str
    value: Array


@dataclass(frozen=True)
class Row:
    """One quantity of the six joints.

    Attributes:
        label: Name, symbol and unit.
        values: Shape (6,) or (6, 2).
        path: XPath of the elements that hold it, with {} for the joint; empty: it is not in the file.
        attribute: Attribute of these elements.
        source: Where it comes from.
    """

    label: str
    values: Array
    path: str
    attribute: str
    source: str


@dataclass(frozen=True)
class Drives:
    """Derived figures of the six drives, each shape (6,), SI units, rounded as hh150.xml holds them."""

    inertia: Array
    motor_friction: Array
    link_friction: Array
    motor_presliding: Array
    link_presliding: Array
    viscous: Array
    damping: Array
    kp: Array
    kv: Array
    ki: Array
    limit: Array


def rounded(values: Array, digits: int = 4) -> Array:
    """Return values rounded to significant digits."""
    return np.array([float(f"{value:.{digits}g}") for value in np.ravel(values)]).reshape(np.shape(values))


def poses() -> Iterator[Array]:
    """Yield poses [rad] over the working range; nothing asked of them depends on joint 1, and hardly on joint 6."""
    q3 = (-190, -150, -110, -90, -60, -30, 0, 30, 54)
    for angles in product((0,), (-40, -10, 20, 50, 80, 110), q3, (0, 45, 90), range(-120, 121, 30), (0,)):
        yield np.array(angles) * DEG


@cache
def drives() -> Drives:
    """Return the figures of the drives; README.md says in words how each is derived."""
    inertia = rounded(ROTOR_INERTIA * GEAR_RATIO**2)
    masses = [arm.mass_matrix(q) for q in poses()]
    least_inertia = np.min([1 / np.diag(np.linalg.inv(mass)) for mass in masses], axis=0)
    greatest_inertia = np.max([np.diag(mass) for mass in masses], axis=0)

    friction = UNLOADED_CURRENT * arm.XI
    motor_friction, link_friction = rounded((1 - LINK_SHARE) * friction), rounded(LINK_SHARE * friction)
    per_inertia = (STEP_RULE / COARSEST_STEP) ** 2
    motor_presliding = rounded(np.minimum(motor_friction / PRESLIDING, per_inertia * inertia), 3)
    link_presliding = rounded(np.minimum(link_friction / PRESLIDING, per_inertia * least_inertia), 3)
    viscous = rounded(friction / VISCOUS_SPEED)
    damping = rounded(2 * ELEMENT_DAMPING * np.sqrt(STIFFNESS * np.diag(arm.mass_matrix(HOME))))

    static = np.max([np.abs(arm.holding_torque(q)) for q in poses()], axis=0)
    reach = [arm.jacobian(arm.frames(q), 6, arm.LOAD_POINT) for q in poses()]
    lever = np.max([np.linalg.norm(linear, axis=0) for linear, _ in reach], axis=0)
    load = arm.RATED_FORCE * lever + arm.RATED_MOMENT  # axes are unit vectors
    motion = (inertia + greatest_inertia) * SPEED_LIMIT / ACCELERATION_TIME + friction + viscous * SPEED_LIMIT
    kp, kv = rounded(inertia * BANDWIDTH**2), rounded(2 * inertia * BANDWIDTH)
    return Drives(
        inertia=inertia,
        motor_friction=motor_friction,
        link_friction=link_friction,
        motor_presliding=motor_presliding,
        link_presliding=link_presliding,
        viscous=viscous,
        damping=damping,
        kp=kp,
        kv=kv,
        ki=rounded((kp + motor_presliding) / RESET_TIME),
        limit=np.ceil((static + load + motion) / 100) * 100,
    )


def rows() -> tuple[Row, ...]:
    """Return everything that hh150.xml holds joint by joint."""
    d = drives()
    joint, rotor = ".//joint[@name='joint{}']", ".//joint[@name='rotor{}']"
    element, servo = "tendon/fixed[@name='element{}']", "actuator/pid[@name='servo{}']"
    motor, link = (f"extension/plugin/instance[@name='{side}_friction']/config" for side in ("motor", "link"))
    level, sigma = "[@key='coulomb']", "[@key='presliding_stiffness']"
    speed = rounded(SPEED_LIMIT)
    return (
        Row("range [rad]", arm.RANGE, joint, "range", "Table 1"),
        Row("element: stiffness k [Nm/rad]", STIFFNESS, element, "stiffness", "Table 6, row Current"),
        Row("element: damping [Nm s/rad]", d.damping, element, "damping", "derived"),
        Row("rotor: J_m N² [kg m²]", d.inertia, rotor, "armature", "assumed, KR300"),
        Row("rotor: viscous friction [Nm s/rad]", d.viscous, rotor, "damping", "assumed"),
        Row("friction, motor side: level [Nm]", d.motor_friction, motor + level, "value", "reconstructed, 70 %"),
        Row("friction, motor side: sigma [Nm/rad]", d.motor_presliding, motor + sigma, "value", "derived"),
        Row("friction, link side: level [Nm]", d.link_friction, link + level, "value", "reconstructed, 30 %"),
        Row("friction, link side: sigma [Nm/rad]", d.link_presliding, link + sigma, "value", "derived"),
        Row("servo: kp [Nm/rad]", d.kp, servo, "kp", "derived"),
        Row("servo: kv [Nm s/rad]", d.kv, servo, "kv", "derived"),
        Row("servo: ki [Nm/(rad s)]", d.ki, servo, "ki", "derived"),
        Row("servo: imax [rad s]", rounded(d.limit / d.ki), servo, "imax", "derived"),
        Row("servo: torque limit [Nm]", np.column_stack([-d.limit, d.limit]), servo, "forcerange", "derived"),
        Row("servo: position range [rad]", arm.RANGE, servo, "posrange", "Table 1"),
        Row("servo: speed limit [rad/s]", np.column_stack([-speed, speed]), servo, "velrange", "assumed, KR300"),
    )


def settled_home() -> tuple[Array, Array]:
    """Return link angles [rad] and motor torques [Nm] at rest with the motors at HOME: theta = q - tau / k."""
    theta = HOME
    for _ in range(20):
        theta = HOME - arm.holding_torque(theta) / STIFFNESS
    return theta, arm.holding_torque(theta)


def numbers() -> Iterator[Number]:
    """Yield every number that hh150.xml has to hold."""
    for row in rows():
        if "{}" not in row.path:
            yield Number(row.path, row.attribute, row.values)  # one attribute for all joints
            continue
        for i in range(6):
            yield Number(row.path.format(i + 1), row.attribute, row.values[i])
    for part in PARTS:
        inertial = f".//body[@name='{part.name}']/inertial"
        yield Number(inertial, "mass", np.array(part.mass))
        yield Number(inertial, "pos", np.array(part.com))
        yield Number(inertial, "diaginertia", rounded(part.inertia))
    origins = np.diff(arm.ZERO[:, :3, 3], axis=0, prepend=0)
    for link, name in enumerate(("column", "upper_arm", "forearm", "forearm_tube", "wrist", "flange")):
        if np.any(origins[link]):
            yield Number(f".//body[@name='{name}']", "pos", origins[link])
    yield Number(".//body[@name='cylinder']", "pos", arm.ANCHOR_A.round(12))
    yield Number(".//site[@name='cbs_b']", "pos", arm.ANCHOR_B)
    yield Number(".//body[@name='load']", "pos", arm.LOAD_POINT)
    yield Number(".//site[@name='reference_point']", "pos", arm.REFERENCE_POINT)
    gas = "actuator/plugin[@name='cbs']/config"
    yield Number(gas + "[@key='constant']", "value", np.array(arm.GAS_CONSTANT))
    yield Number(gas + "[@key='critical_length']", "value", np.array(arm.CRITICAL_LENGTH))
    yield Number("option", "timestep", np.array(STEP_SIZE))
    yield Number("option", "gravity", np.array([0, 0, -arm.GRAVITY]))
    theta, torque = settled_home()
    yield Number("keyframe/key[@name='home']", "qpos", np.concatenate([theta, HOME]).round(9))
    yield Number("keyframe/key[@name='home']", "act", (torque / drives().ki).round(12))


def loop_poles(q: Array, payload: float, stuck: bool) -> Array:
    """Return the poles [1/s] of servo, rotors, elements and links at a pose, all friction either slipping or stuck."""
    d = drives()
    zero, k, c = np.zeros((6, 6)), np.diag(STIFFNESS), np.diag(d.damping)
    hold = np.diag(d.motor_presliding) if stuck else zero
    hold_link = np.diag(d.link_presliding) if stuck else zero
    stiffness = np.block([[k + np.diag(d.kp) + hold, -k], [-k, k + hold_link]])
    damping = np.block([[c + np.diag(d.kv + d.viscous), -c], [-c, c]])
    inertia = np.block([[np.diag(d.inertia), zero], [zero, arm.mass_matrix(q, payload)]])
    integral = np.concatenate([np.diag(d.ki), zero])
    acceleration = -np.linalg.solve(inertia, np.hstack([stiffness, damping, -integral]))
    velocity = np.hstack([np.zeros((12, 12)), np.eye(12), np.zeros((12, 6))])
    error = np.hstack([-np.eye(6), np.zeros((6, 24))])
    return np.linalg.eigvals(np.vstack([velocity, acceleration, error]))


def text(value: Array) -> str:
    """Return numbers as README.md writes them."""
    parts = [f"{part:.4g}".replace("e+0", "e").replace("e-0", "e-") for part in np.ravel(value)]
    return f"±{parts[1]}" if len(parts) == 2 and parts[0] == f"-{parts[1]}" else " ".join(parts)


def tables() -> Iterator[str]:
    """Yield the lines of the tables in README.md."""
    yield "| | 1 | 2 | 3 | 4 | 5 | 6 | source |"
    yield "|---|---|---|---|---|---|---|---|"
    for row in rows():
        yield f"| {row.label} | {' | '.join(text(value) for value in row.values)} | {row.source} |"
    yield ""
    yield "| body | mass [kg] | centre of mass [m] | solid that gives the inertia [m] | Ixx Iyy Izz [kg m²] |"
    yield "|---|---|---|---|---|"
    for part in PARTS:
        *size, last = part.solid
        solid = f"box {text(np.array(part.solid))}"
        if len(part.solid) == 4:
            solid = f"tube {text(np.array(size))} along {'xyz'[int(last)]}"
        yield f"| {part.name} | {part.mass:g} | {text(np.array(part.com))} | {solid} | {text(part.inertia)} |"
    yield ""
    yield "| pose | payload [kg] | slowest pole [1/s], slipping / stuck | least damping ratio, slipping / stuck |"
    yield "|---|---|---|---|"
    reconstructed = json.loads((HERE / "paper" / "configurations.json").read_text())["A1"]["q_deg"]
    named = {"home": HOME, "arm stretched": np.array([0, 90, -90, 0, 0, 0]) * DEG}
    named |= {f"A1, configuration {i}": np.array(q) * DEG for i, q in enumerate(reconstructed, start=1)}
    for name, q in named.items():
        for payload in (0.0, PAYLOAD):
            poles = [loop_poles(q, payload, stuck) for stuck in (False, True)]
            slowest = np.array([loop.real.max() for loop in poles])
            ratios = np.array([np.min(-loop.real / np.abs(loop)) for loop in poles])
            cells = (" / ".join(text(value) for value in rounded(column, 2)) for column in (slowest, ratios))
            yield f"| {name} | {payload:g} | {' | '.join(cells)} |"


def differences() -> list[str]:
    """Return one sentence per number that hh150.xml or README.md holds wrongly or not at all."""
    root = ElementTree.parse(HERE / "hh150.xml").getroot()
    found = []
    for number in numbers():
        elements = root.findall(number.path)
        if len(elements) != 1:
            found.append(f"hh150.xml: {number.path}: {len(elements)} elements, expected 1")
            continue
        held = np.array((elements[0].get(number.attribute) or "nan").split(), dtype=float)
        expected = np.ravel(number.value)
        if held.shape != expected.shape or not np.allclose(held, expected, rtol=1e-9, atol=1e-12):
            found.append(f"hh150.xml: {number.path}: {number.attribute}={held}, derived {expected.tolist()}")
    readme = (HERE / "README.md").read_text(encoding="utf-8").splitlines()
    found += [f"README.md: lacks this line: {line}" for line in tables() if line not in readme]
    return found


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        problems = differences()
        print("\n".join(problems) or "hh150.xml and README.md hold every derived number.")
        sys.exit(1 if problems else 0)
    print("\n".join(tables()))
