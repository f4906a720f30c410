"""Write kr300.xml from the figures that were published with the recordings (`robot.json`).

    python derive.py ROBOT_JSON            write kr300.xml
    python derive.py ROBOT_JSON --check    compare it with the file instead

README.md says where every number comes from; what is assumed stands at the top of this file.
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
HERE = Path(__file__).parent
DEG = np.pi / 180.0

# Assumed
STIFFNESS = np.array([5.59e5, 1.435e6, 1.829e6, 1.84e5, 1.71e5, 7.0e4])  # [Nm/rad], HH-150, Table 6: the same class
RANGE = np.array([[-185, 185], [-50, 85], [-210, 65], [-350, 350], [-122.5, 122.5], [-350, 350]]) * DEG  # data sheet
SPEED_LIMIT = np.array([95, 90, 95, 108, 107, 158]) * DEG  # [rad/s], data sheet of the KR QUANTEC ultra
TORQUE_LIMIT = np.array([14000, 20000, 12000, 4000, 4000, 2600])  # [Nm], motors of 55, 75, 48, 18, 17, 17 Nm
FLANGE_RADIUS, FLANGE_LENGTH = 0.1, 0.1  # [m], solid cylinder that gives link 6 the inertia that was not published
ELEMENT_DAMPING = 0.05  # ratio of a single joint at home with its rotor held
BANDWIDTH = 2 * np.pi * 20.0  # [rad/s] of the servo
RESET_TIME = 0.5  # [s], integral action
PRESLIDING = np.array([1e6, 1e7, 8e6, 4e5, 1e6, 1e5])  # [Nm/rad] of both friction elements
ANCHOR_Y = -0.4  # [m], plane of the cylinder beside the arm; changes neither its length nor its torque

BODIES = ("column", "upper_arm", "forearm", "forearm_tube", "wrist", "flange")
SHAPES = (  # geoms of each link, in the frame of its body: capsules from the joint towards the next one, for the eye
    '<geom type="cylinder" size="0.33 0.16" pos="0 0 -0.45" material="orange"/>',
    '<geom type="cylinder" size="0.17 0.2" pos="0 0 -0.05" material="orange"/>',
    '<geom type="cylinder" size="0.15 0.16" material="orange"/>',
    '<geom type="cylinder" size="0.12 0.1" pos="0 0 -0.35" material="orange"/>',
    '<geom type="sphere" size="0.1" material="charcoal"/>',
    '<geom type="cylinder" size="0.1 0.03" pos="0 0 -0.21" material="steel"/>',
)


@dataclass(frozen=True)
class Link:
    """One link in the frame of its body, which turns about its z axis.

    Attributes:
        origin: Shape (3,) [m], of the body frame in the frame of the body before it.
        rotation: Shape (3, 3), orientation of the same at joint angle zero.
        tip: Shape (3,) [m], origin of the next frame.
        mass: [kg].
        com: Shape (3,) [m].
        inertia: Shape (3, 3) [kg m^2], about the centre of mass.
        rotor: J_m N^2 [kg m^2].
    """

    origin: Array
    rotation: Array
    tip: Array
    mass: float
    com: Array
    inertia: Array
    rotor: float


def turn(axis: int, angle: float) -> Array:
    """Return the rotation by an angle [rad] about a coordinate axis, shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix


def links(robot: dict[str, Any]) -> list[Link]:
    """Return the links: distal Denavit-Hartenberg frames, each with its constant turn about z put before the joint."""
    found, rotation, origin = [], turn(0, np.pi), np.zeros(3)  # base frame turned about x
    for row, home in zip(robot["links"], robot["home_offset_deg"], strict=True):
        zero = rotation @ turn(2, (home + row["dh_offset_deg"]) * DEG)
        twist = turn(0, row["alpha_deg"] * DEG)
        tip = np.array([row["a_m"], 0.0, row["d_m"]])
        found.append(
            Link(
                origin=origin,
                rotation=zero,
                tip=tip,
                mass=row["mass_kg"],
                com=tip + twist @ np.array(row["com_m"]),
                inertia=twist @ _inertia(row) @ twist.T,
                rotor=row["rotor_inertia_kgm2"] * row["gear_ratio"] ** 2,
            )
        )
        rotation, origin = twist, tip
    return found


def _inertia(row: dict[str, Any]) -> Array:
    given = row["inertia_about_com_kgm2"]
    if given is None:
        across = row["mass_kg"] * (FLANGE_RADIUS**2 / 4 + FLANGE_LENGTH**2 / 12)
        return np.diag([across, across, row["mass_kg"] * FLANGE_RADIUS**2 / 2])
    return np.array([[given["".join(sorted(i + j))] for j in "xyz"] for i in "xyz"])


def gas(robot: dict[str, Any]) -> tuple[float, float, float]:
    """Return C [Nm] and l_c [m] of Eq. (8), and the area that the gas pulls at [m^2]."""
    figures = robot["counterbalance"]
    area = np.pi / 4 * (figures["piston_diameter_m"] ** 2 - figures["rod_diameter_m"] ** 2)
    shortest = figures["anchor_distance_link1_m"] - figures["anchor_distance_link2_m"]
    amount = figures["nitrogen_mass_kg"] * figures["gas_constant_J_per_kgK"] * figures["temperature_K"]
    return amount * figures["compressibility"], shortest + figures["gas_volume_m3"] / area, area


def mjcf(robot: dict[str, Any]) -> str:
    """Return the text of kr300.xml."""
    arm = links(robot)
    text = _text(robot, arm, "")
    model = mujoco.MjModel.from_xml_string(text)
    theta = np.zeros(6)
    for _ in range(20):  # theta = q - tau / k, with the motors at zero
        theta = -_held(model, theta) / STIFFNESS
    act = _held(model, theta) / _servo(arm)[2]
    qpos = np.concatenate([theta, np.zeros(6)])
    home = (
        "\n  <keyframe>\n    <!-- At rest: links sag by tau / k, integral action holds the arm; order theta, q -->\n"
        f'    <key name="home"\n      qpos="{_row(qpos.round(12))}"\n      act="{_row(act.round(12))}"\n'
        f'      ctrl="{_row(np.zeros(12))}"/>\n  </keyframe>\n'
    )
    return _text(robot, arm, home)


def _held(model: mujoco.MjModel, theta: Array) -> Array:
    """Return the torque that holds the links against gravity, shape (6,) [Nm]."""
    data = mujoco.MjData(model)
    data.qpos[:6] = theta
    mujoco.mj_forward(model, data)
    return np.array(data.qfrc_bias[:6])


def _servo(arm: list[Link]) -> tuple[Array, Array, Array]:
    """Return kp [Nm/rad], kv [Nm s/rad] and ki [Nm/(rad s)]."""
    inertia = np.array([link.rotor for link in arm])
    kp = rounded(inertia * BANDWIDTH**2)
    return kp, rounded(2 * inertia * BANDWIDTH), rounded((kp + PRESLIDING) / RESET_TIME)


def rounded(values: Array, digits: int = 4) -> Array:
    """Return values to so many significant digits."""
    return np.array([float(f"{value:.{digits - 1}e}") for value in np.atleast_1d(values)])


def _number(value: float) -> str:
    text = f"{value:.12g}"
    return "0" if text == "-0" else text


def _row(values: Array) -> str:
    return " ".join(_number(value) for value in np.ravel(values))


def _quat(rotation: Array) -> str:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, rotation.ravel())
    return _row(quaternion.round(12))


def _links(robot: dict[str, Any], arm: list[Link]) -> list[str]:
    """Return the lines of the nested bodies."""
    figures, lines = robot["counterbalance"], []
    # Directions in the column's frame at zero: the upper arm points along x of its own body
    shortest = turn(2, float(figures["shortest_at"].split("angle of ")[1].split(" ")[0]) * DEG)
    along = turn(0, robot["links"][0]["alpha_deg"] * DEG) @ shortest @ np.array([1.0, 0.0, 0.0])
    across = turn(0, robot["links"][0]["alpha_deg"] * DEG) @ np.array([0.0, 0.0, 1.0])
    anchor_a = arm[0].tip - figures["anchor_distance_link1_m"] * along + ANCHOR_Y * across
    anchor_b = np.array([-figures["anchor_distance_link2_m"], 0.0, ANCHOR_Y])
    for i, (name, link) in enumerate(zip(BODIES, arm, strict=True)):
        pad = "  " * (i + 3)
        inertia = link.inertia.round(9)
        entries = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        place = f'pos="{_row(link.origin.round(12))}" quat="{_quat(link.rotation)}"'
        lines += [
            f"{pad}<!-- Link {i + 1} -->",
            f'{pad}<body name="{name}" {place}>',
            f'{pad}  <inertial mass="{_number(link.mass)}" pos="{_row(link.com.round(12))}"',
            f'{pad}    fullinertia="{_row(np.array(entries))}"/>',
            f'{pad}  <joint name="joint{i + 1}" axis="0 0 1" range="{_row(RANGE[i].round(12))}"/>',
            f"{pad}  {SHAPES[i]}",
        ]
        if np.linalg.norm(link.tip) > 0.1 and i < 5:
            ends = f"0 0 {_number(link.tip[2])} {_row(link.tip)}" if i in (0, 1, 2) else f"0 0 0 {_row(link.tip)}"
            if np.linalg.norm(link.tip[:2]) > 0.1 or i > 2:
                lines.append(f'{pad}  <geom type="capsule" size="0.1" fromto="{ends}" material="orange"/>')
        if i == 0:
            lines.append(f'{pad}  <site name="cbs_a" pos="{_row(anchor_a.round(12))}"/>')
        if i == 1:
            lines.append(f'{pad}  <site name="cbs_b" pos="{_row(anchor_b)}"/>')
    twist = turn(0, robot["links"][5]["alpha_deg"] * DEG)
    hook = arm[5].tip + twist @ np.array(robot["payload"]["com_m"])
    pad = "  " * 9
    lines += [
        f"{pad}<!-- The payload's centre, and where world wrenches act; see ../README.md for the inertial -->",
        f'{pad}<body name="load" pos="{_row(hook.round(12))}" quat="{_quat(twist)}">',
        f'{pad}  <inertial mass="0" pos="0 0 0" diaginertia="0 0 0"/>',
        f'{pad}  <site name="load_point"/>',
        f"{pad}</body>",
    ]
    return lines + [f"{'  ' * (i + 3)}</body>" for i in reversed(range(6))]


def _text(robot: dict[str, Any], arm: list[Link], home: str) -> str:
    kp, kv, ki = _servo(arm)
    constant, critical, _ = gas(robot)
    damping = rounded(2 * ELEMENT_DAMPING * np.sqrt(STIFFNESS * _diagonal(arm)))
    rotors, elements, servos, friction = [], [], [], {"motor": [], "link": []}
    for i in range(6):
        n = i + 1
        rotors.append(
            f'    <body name="rotor{n}" pos="{_row(np.array([0.1 * (i % 3 - 1), 0.08 if i > 2 else -0.08, 0.2]))}"'
            f' childclass="kr300">\n'
            f'      <inertial mass="0.001" pos="0 0 0" diaginertia="1e-6 1e-6 1e-6"/>\n'
            f'      <joint name="rotor{n}" class="rotor" armature="{_number(float(f"{arm[i].rotor:.6g}"))}"/>\n'
            f'      <geom class="rotor"/>\n    </body>'
        )
        elements.append(
            f'    <fixed name="element{n}" stiffness="{_number(STIFFNESS[i])}" damping="{_number(damping[i])}">\n'
            f'      <joint joint="rotor{n}" coef="1"/>\n      <joint joint="joint{n}" coef="-1"/>\n    </fixed>'
        )
        limits = np.array([-TORQUE_LIMIT[i], TORQUE_LIMIT[i]], dtype=float)
        servos.append(
            f'    <pid name="servo{n}" class="kr300" joint="rotor{n}" kp="{_number(kp[i])}" kv="{_number(kv[i])}"'
            f' ki="{_number(ki[i])}"\n      imax="{_number(float(f"{TORQUE_LIMIT[i] / ki[i]:.4g}"))}"'
            f' forcerange="{_row(limits)}" posrange="{_row(RANGE[i].round(12))}"\n'
            f'      velrange="{_row(np.array([-1, 1]) * SPEED_LIMIT[i].round(4))}"/>'
        )
        for side, joint in (("motor", "rotor"), ("link", "joint")):
            friction[side].append(
                f'    <plugin name="{side}_friction{n}" joint="{joint}{n}" instance="{side}_friction"/>'
            )
    template = (HERE / "kr300.template.xml").read_text(encoding="utf-8")
    filled = {
        "bodies": "\n".join(_links(robot, arm)),
        "rotors": "\n".join(rotors),
        "elements": "\n".join(elements),
        "servos": "\n".join(servos),
        "friction": "\n".join(friction["motor"] + friction["link"]),
        "presliding": _row(PRESLIDING),
        "constant": _number(float(f"{constant:.8g}")),
        "critical": _number(float(f"{critical:.8g}")),
        "keyframe": home,
    }
    for key, value in filled.items():
        template = template.replace("{{" + key + "}}", value)
    return template


def _diagonal(arm: list[Link]) -> Array:
    """Return the inertia of each joint with all others held at zero, shape (6,) [kg m^2]."""
    origin, rotation, placed = np.zeros(3), np.eye(3), []
    for link in arm:
        origin = origin + rotation @ link.origin
        rotation = rotation @ link.rotation
        placed.append((origin, rotation, link))
    values = []
    for i, (foot, frame, _) in enumerate(placed):
        axis, total = frame[:, 2], 0.0
        for place, turned, link in placed[i:]:
            arm_vector = np.cross(axis, place + turned @ link.com - foot)
            total += link.mass * arm_vector @ arm_vector + axis @ turned @ link.inertia @ turned.T @ axis
        values.append(total)
    return np.array(values)


def main(arguments: list[str]) -> int:
    """Write or check kr300.xml; return the exit code."""
    text = mjcf(json.loads(Path(arguments[0]).read_text(encoding="utf-8")))
    file = HERE / "kr300.xml"
    if "--check" in arguments:
        same = file.read_text(encoding="utf-8") == text
        print(f"{file.name} {'holds' if same else 'differs from'} what follows from {arguments[0]}")
        return 0 if same else 1
    file.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
