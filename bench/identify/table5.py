"""The paper's loading experiment, Table 5, as readings for the methods, in *reconstructed* poses.

The paper prints no joint angles, load point or measuring point. `configurations.json` and `alternatives.json` hold
sets of them that reproduce Table 5 about equally well. What these files are and how far they reach:
models/hh150/paper/README.md.
"""

import csv
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.denavit_hartenberg import Row, bodies_from_table
from bench.identify.readings import StaticReadings, Systematic
from bench.robot.bodies import read_only

Array = NDArray[np.float64]

DEGREE = np.pi / 180
MILLIMETRE = 1e-3  # [m]
TORQUE_CONSTANT = read_only([169.6355, 220.8436, 220.8436, 127.0724, 138.3101, 139.4627])  # [Nm/A], Table 2
N_REPEATS = 10  # section 5
SIGMA_CURRENT = np.hypot(0.02, 0.01 / np.sqrt(12))  # [A], one reading: nominal noise, and rounding as printed
SIGMA_REFLECTOR = 30e-6  # [m], one reading: 10 um/m, section 5, at the 3 m assumed for such a robot
SIGMA_WRENCH = read_only([0.5] * 3 + [0.2] * 3)  # [N, Nm], nominal

# Table 1: a_{i-1} [m], alpha_{i-1}, d_i [m], angle at the robot's zero, limits. The links carry no mass: gravity
# stiffness and k_b change the results by less than 0.5 %, two orders below what the poses leave open.
TABLE_1 = tuple(
    Row(a, alpha * DEGREE, d, zero * DEGREE, (low * DEGREE, high * DEGREE))
    for a, alpha, d, zero, low, high in (
        (0.0, 0, 0.683, 0, -185, 185),
        (0.35, -90, 0.0, -90, -40, 110),
        (1.2, 0, 0.0, 180, -190, 54),
        (0.0, -90, -1.049, 0, -350, 350),
        (0.0, 90, 0.0, 0, -120, 120),
        (0.0, -90, 0.0, 0, -350, 350),
    )
)


@dataclass(frozen=True)
class Table5:
    """Table 5 as printed, 24 rows.

    Attributes:
        configuration: Shape (24,) int, 1 to 6.
        force: Shape (24, 3) [N]; of configurations 1 to 4 the magnitude of a hanging load stands in z.
        current: Shape (24, 6) [A], signs as printed.
        deflection: Shape (24, 3) [m]; zero in the unloaded rows, against which it was measured.
    """

    configuration: NDArray[np.int64]
    force: Array
    current: Array
    deflection: Array

    @property
    def is_reference(self) -> NDArray[np.bool_]:
        """Shape (24,), the unloaded rows."""
        return np.array(np.all(self.force == 0, axis=1))

    @property
    def hangs(self) -> NDArray[np.bool_]:
        """Shape (24,), rows of configurations with a vertical load: those that have no horizontal force."""
        slanting = np.unique(self.configuration[np.any(self.force[:, :2] != 0, axis=1)])
        return ~np.isin(self.configuration, slanting)


@dataclass(frozen=True)
class Reconstruction:
    """One set of poses and points that reproduces Table 5; see the module's docstring.

    Attributes:
        name: "A1", or family and number of an alternative.
        family: How it was found: which torque was held responsible for the deflection, and with which stiffness.
        q: Shape (6, 6) [rad], one row per configuration.
        load_point: Shape (3,) [m], frame 6.
        reflector: Shape (3,) [m], frame 6; the measuring point.
        current_signs: Shape (6,), s_j in Gamma_j = s_j xi_j dI_j.
        assumed_stiffness: Shape (6,) [Nm/rad], held fixed or fitted in finding it.
    """

    name: str
    family: str
    q: Array
    load_point: Array
    reflector: Array
    current_signs: Array
    assumed_stiffness: Array

    def arm(self) -> Arm:
        """Return the arm of Table 1 with the points "load" and "reflector" of this reconstruction."""
        return Arm(bodies_from_table(TABLE_1, {"load": self.load_point.tolist(), "reflector": self.reflector.tolist()}))

    def readings(self, table: Table5) -> StaticReadings:
        """Return Table 5 as readings in these poses.

        There is one reflector, so there is no orientation. The motors are taken to hold the pose. Noise is nominal; the
        scatter of the deflections about straight lines over the load (`bench.identify.table5_lines`) bears it out.
        """
        series = table.configuration - 1
        force = np.where(table.hangs[:, None], -1.0, 1.0) * table.force
        return StaticReadings(
            series=series,
            is_reference=table.is_reference,
            q_motor=self.q[series],
            current_torque=-self.current_signs * TORQUE_CONSTANT * table.current,
            reflectors=table.deflection[:, None],
            wrench=np.concatenate([force, np.zeros_like(force)], axis=1),
            is_vertical=table.hangs,
            n_repeats=np.full(len(series), N_REPEATS),
            sigma_current_torque=TORQUE_CONSTANT * SIGMA_CURRENT,
            sigma_reflector=SIGMA_REFLECTOR,
            sigma_wrench=SIGMA_WRENCH,
            reflector_names=("reflector",),
            load_point="load",
            systematic=Systematic(np.full(6, np.hypot(0.02, 0.005))),
        )


def read_table5(folder: Path) -> Table5:
    """Read `table5.csv` of a folder.

    Raises:
        InputError: The file is missing, or lacks a column.
    """
    rows = _rows(folder / "table5.csv")
    columns = (("fx_N", "fy_N", "fz_N"), tuple(f"i{j}_A" for j in range(1, 7)), ("dx_mm", "dy_mm", "dz_mm"))
    lacking = [name for names in (("configuration",), *columns) for name in names if name not in rows[0]]
    if lacking:
        raise InputError(f"{folder / 'table5.csv'}: columns are missing: {', '.join(lacking)}.")
    force, current, deflection = (np.array([[float(row[n] or 0) for n in names] for row in rows]) for names in columns)
    configuration = np.array([int(row["configuration"]) for row in rows])
    return Table5(configuration, force, current, MILLIMETRE * deflection)


def read_table6(folder: Path) -> dict[str, Array]:
    """Read `table6.csv` of a folder: the paper's stiffness by method, shape (6,) [Nm/rad].

    Raises:
        InputError: The file is missing.
    """
    names = [f"k{j}_nm_per_rad" for j in range(1, 7)]
    return {row["method"]: np.array([float(row[name]) for name in names]) for row in _rows(folder / "table6.csv")}


def read_reconstructions(folder: Path) -> tuple[Reconstruction, ...]:
    """Read `configurations.json` and `alternatives.json` of a folder, the named ones first.

    Raises:
        InputError: A file is missing.
    """
    named, other = (_json(folder / f"{name}.json") for name in ("configurations", "alternatives"))
    table6 = read_table6(folder)
    found = [
        Reconstruction(
            name=name,
            family=entry["note"],
            q=read_only(entry["q_deg"]) * DEGREE,
            load_point=read_only(entry["p_f_frame6_m"]),
            reflector=read_only(entry["p_m_frame6_m"]),
            current_signs=read_only(entry["current_signs"]),
            assumed_stiffness=table6["current"],
        )
        for name, entry in named.items()
    ]
    for family, entries in other.items():
        for number, entry in enumerate(entries, start=1):
            s4, s6 = entry["s4s6"]
            found.append(
                Reconstruction(
                    name=f"{family}/{number}",
                    family=family,
                    q=read_only(entry["q_deg"]) * DEGREE,
                    load_point=read_only(entry["pf"]),
                    reflector=read_only(entry["pm"]),
                    current_signs=read_only([-1, 1, 1, s4, 1, s6]),
                    assumed_stiffness=read_only(entry["k"]),
                )
            )
    return tuple(found)


def _rows(file: Path) -> list[dict[str, str]]:
    if not file.is_file():
        raise InputError(f"{file}: no such file; give the folder with the paper's tables (models/hh150/paper).")
    with file.open(newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def _json(file: Path) -> dict[str, Any]:
    if not file.is_file():
        raise InputError(f"{file}: no such file; give the folder with the paper's tables (models/hh150/paper).")
    content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return content
