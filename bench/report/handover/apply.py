"""What `bench apply` writes: a robot for other programs."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from bench.record import csv_table
from bench.report.handover.applied import Applied
from bench.report.handover.drag import drag_of
from bench.report.handover.feed_forward import PARTS, FeedForward
from bench.report.handover.urdf import urdf_of
from bench.report.handover.urdf_gaps import gaps_of
from bench.robot.folder import Robot
from bench.simulate.prescribed import Motion

TORQUES = "torque.csv"
DRIVES = "drives.csv"
README = "README.md"


def write_applied(applied: Applied, table: FeedForward | None, folder: Path) -> None:
    """Write URDF, figures of the drives and, if there is one, the table of torques into an existing folder."""
    compiled, robot = applied.compiled, applied.compiled.robot
    urdf = urdf_name(robot)
    (folder / urdf).write_text(urdf_of(applied, Path(urdf).stem), encoding="utf-8")
    units = tuple("n" if slide else "nm" for slide in compiled.is_slide)
    if table is not None:
        csv_table.write(folder / TORQUES, table.columns(units))
    _write_drives(folder / DRIVES, applied)
    lines = [
        f"# {robot.figures.title}, for other programs",
        "",
        f"Written by `bench apply` from `{robot.folder}`, with {applied.conditions.payload_kg:g} kg bolted on beside",
        "what its model carries (a payload that was fitted is in it), at the temperatures for which its figures hold.",
        "SI units; of a slide kg for kg m^2, N for Nm, m for rad.",
        "",
        f"- `{urdf}`: links with inertials, joints with limits, Coulomb (`friction`) and viscous (`damping`) friction.",
        f"- `{DRIVES}`: of each joint rotor inertia, stiffness, friction and torque constant.",
    ]
    if table is not None:
        lines += [
            f"- `{TORQUES}`: motor torques along the motion. `torque_i` is the sum of `links_i` (rigid links: URDF),",
            "  `rotor_i`, `friction_i`, `balance_i` (counterbalance) and `rest_i` (give of gears, learned torques).",
            "  `current_i_a` or `tau_motor_i_nm` is what the drive will show for it. Friction is that of the motion",
            "  before; where the robot stands it may have any value up to its level.",
        ]
    lines += ["", "## What the URDF cannot say", "", *(f"- {words}." for words in gaps_of(applied))]
    (folder / README).write_text("\n".join(lines) + "\n", encoding="utf-8")


def urdf_name(robot: Robot) -> str:
    """Return the name of the URDF file of a robot."""
    return f"{robot.mjcf.stem}.urdf"


def summary(table: FeedForward, names: tuple[str, ...]) -> Iterator[str]:
    """Yield a table for people: root mean squares of the torques and their parts, joint by joint."""
    yield "root mean square [Nm], of a slide [N]:"
    yield "  " + "".join(f"{word:>12}" for word in ("joint", "torque", *PARTS))
    whole: Mapping[str, np.ndarray] = {"torque": table.torque, **table.parts}
    for j, name in enumerate(names):
        sizes = [float(np.sqrt(np.mean(values[:, j] ** 2))) for values in whole.values()]
        yield "  " + f"{name:>12}" + "".join(f"{size:12.4g}" for size in sizes)


def beyond(table: FeedForward, motion: Motion, applied: Applied) -> Iterator[str]:
    """Yield a sentence for every drive that the motion asks for more speed or torque than it gives."""
    compiled = applied.compiled
    torques = compiled.model.actuator_forcerange[compiled.at.servo, 1]
    speeds = [drive.speed_limit_rad_per_s for drive in compiled.robot.figures.drives]
    for j, name in enumerate(applied.bodies.names):
        force, speed = ("N", "m/s") if compiled.is_slide[j] else ("Nm", "rad/s")
        for values, most, unit in ((motion.velocity, speeds[j], speed), (table.torque, torques[j], force)):
            row = int(np.argmax(np.abs(values[:, j])))
            if abs(values[row, j]) > most:
                at = f"at {motion.time[row]:g} s"
                yield f"{name}: {abs(values[row, j]):.4g} {unit} {at}, more than the {most:.4g} {unit} of its drive"


def _write_drives(path: Path, applied: Applied) -> None:
    compiled, model, at = applied.compiled, applied.compiled.model, applied.compiled.at
    columns = {
        "joint": [drive.joint for drive in compiled.robot.figures.drives],
        "rotor_inertia_kg_m2": model.dof_armature[at.q_dof].tolist(),
        "stiffness_nm_per_rad": compiled.stiffness.tolist(),
        "coulomb_motor_nm": compiled.motor_coulomb.tolist(),
        "coulomb_link_nm": compiled.link_coulomb.tolist(),
        "viscous_nm_s_per_rad": drag_of(compiled)[:, 0].tolist(),
        "torque_limit_nm": model.actuator_forcerange[at.servo, 1].tolist(),
    }
    if np.any(compiled.motor_rolling):
        columns["rolling_nm_at_1_rad_per_s"] = compiled.motor_rolling.tolist()
    if compiled.robot.figures.instruments.current:
        columns["torque_constant_nm_per_a"] = compiled.torque_constant.tolist()
    rows = [",".join(str(value) for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n", encoding="utf-8")
