"""A stranger's static campaign: the arm of `stranger.py` loaded by weights, read by a laser tracker at rest.

Gravity and Jacobians are Pinocchio's on the arm that is put together there; nothing of the bench has a part in it. A
motor holds its angle, and its friction keeps the sign of the approach; behind it the gear winds up under all that acts.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from bench.record.campaign import Array
from tests import stranger

STIFFNESS = (1.5e4, 1.9e4, 7.0e3)  # [Nm/rad]; the torque limit winds up what new-robot guesses by 10 mrad
NESTS = ((0.30, 0.08, 0.02), (0.28, -0.06, 0.05), (0.20, 0.02, -0.07))  # [m], on the last link
HOOK = (0.3, 0.0, 0.0)  # [m]
MASSES = (0.0, 5.0, 10.0, 5.0, 0.0)  # [kg], put on and taken off
POSES = (  # [deg], and the direction of the load; in the last one a cable over a pulley pulls aside
    ((0, 40, 20), (0, 0, -1)),
    ((60, 60, -40), (0, 0, -1)),
    ((-50, -50, 30), (0, 0, -1)),
    ((20, 80, 30), (0, 0, -1)),
    ((10, 50, 40), (0, -0.7071, -0.7071)),
)
CONSTANT = (12.0, 14.0, 8.0)  # [Nm/A], at the joint
FRICTION = (2.0, 3.0, 1.0)  # [Nm], of the motors
TRACKER = 20e-6  # [m], noise of one coordinate
REPEATS = 3
HEADER = (
    "pose;side;step;rep;t_s;"
    + ";".join(f"cmd_{j}_deg" for j in (1, 2, 3))
    + ";"
    + ";".join(f"enc_{j}_deg" for j in (1, 2, 3))
    + ";Fx_N;Fy_N;Fz_N;"
    + ";".join(f"I_{j}_A" for j in (1, 2, 3))
    + ";"
    + ";".join(f"SMR{k}_{axis}_mm" for k in (1, 2, 3) for axis in "XYZ")
)


def mjcf() -> str:
    """Return the arm with sites where the hook and the reflectors' nests are."""
    sites = f'<site name="hook" pos="{" ".join(map(str, HOOK))}"/>'
    sites += "".join(f'<site name="nest_{k}" pos="{" ".join(map(str, nest))}"/>' for k, nest in enumerate(NESTS, 1))
    return stranger.mjcf().replace('<site name="attachment_site" pos="0.3 0 0"/>', sites)


def logs(folder: Path, rng: np.random.Generator, stiffness: Sequence[float] = STIFFNESS) -> None:
    """Write a log for each pose, as a lab's spreadsheet has it: degrees, millimetres, semicolons.

    Args:
        folder: To write into.
        rng: Source of noise.
        stiffness: Of the gears [Nm/rad].
    """
    links = stranger.as_filed().links
    for k, nest in enumerate((HOOK, *NESTS)):
        links.addFrame(pin.Frame(f"at_{k}", 3, 0, pin.SE3(np.eye(3), np.array(nest)), pin.FrameType.OP_FRAME))
    for number, (angles, direction) in enumerate(POSES, start=1):
        rows, clock = [], 0.0
        q = np.deg2rad(np.array(angles, dtype=float))
        for side in (1, -1):
            friction = side * np.array(FRICTION)
            for step, mass in enumerate(MASSES):
                force = 9.80665 * mass * np.array(direction)
                theta, torque = _at_rest(links, q, force, np.array(stiffness))
                for repeat in range(1, REPEATS + 1):
                    clock += 20.0
                    data = links.createData()
                    pin.framesForwardKinematics(links, data, theta)
                    seen = np.concatenate([data.oMf[links.getFrameId(f"at_{k}")].translation for k in (1, 2, 3)])
                    encoders = np.rad2deg(q + 1e-6 * rng.normal(size=3))
                    currents = (torque + friction) / np.array(CONSTANT) + 0.02 * rng.normal(size=3)
                    millimetres = 1e3 * (seen + TRACKER * rng.normal(size=9))
                    rows.append(
                        [number, side, step, repeat, clock, *angles, *encoders, *force, *currents, *millimetres]
                    )
                clock += 60.0
        text = "".join(";".join(f"{value:.9g}" for value in row) + "\n" for row in rows)
        (folder / f"pose{number}.csv").write_text(f"{HEADER}\n{text}")


def _at_rest(links: pin.Model, q: Array, force: Array, stiffness: Array) -> tuple[Array, Array]:
    """Return the angles of the links [rad] and the torques of the gears [Nm] at rest under a force at the hook [N]."""
    data, theta = links.createData(), q.copy()
    for _ in range(50):
        pin.computeJointJacobians(links, data, theta)
        jacobian = pin.getFrameJacobian(links, data, links.getFrameId("at_0"), pin.LOCAL_WORLD_ALIGNED)[:3]
        torque = pin.computeGeneralizedGravity(links, data, theta) - jacobian.T @ force
        theta = q - torque / stiffness
    return theta, torque
