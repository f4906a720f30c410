"""The paper's loading experiment, Table 5, as readings for the methods, in *reconstructed* poses.

The paper prints no joint angles, load point or measuring point. `configurations.json` and `alternatives.json` hold
sets of them that reproduce Table 5 about equally well. What these files are and how far they reach: the README.md
beside them, in the folder `paper` of the robot's folder.
"""

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.denavit_hartenberg import bodies_from_table
from bench.identify.readings import StaticReadings, Systematic
from bench.identify.table5_experiment import Experiment, read_experiment, text_of
from bench.robot.bodies import Array, read_only

DEGREE = np.pi / 180
MILLIMETRE = 1e-3  # [m]


@dataclass(frozen=True)
class Table5:
    """Table 5 as printed, m rows, and the experiment that it is from; n joints.

    Attributes:
        experiment: The arm and the instruments.
        configuration: Shape (m,) int, from 1.
        force: Shape (m, 3) [N]; where there is no horizontal force, the magnitude of a hanging load stands in z.
        current: Shape (m, n) [A], signs as printed.
        deflection: Shape (m, 3) [m]; zero in the unloaded rows, against which it was measured.
    """

    experiment: Experiment
    configuration: NDArray[np.int64]
    force: Array
    current: Array
    deflection: Array

    @property
    def is_reference(self) -> NDArray[np.bool_]:
        """Shape (m,), the unloaded rows."""
        return np.array(np.all(self.force == 0, axis=1))

    @property
    def hangs(self) -> NDArray[np.bool_]:
        """Shape (m,), rows of configurations with a vertical load: those that have no horizontal force."""
        slanting = np.unique(self.configuration[np.any(self.force[:, :2] != 0, axis=1)])
        return ~np.isin(self.configuration, slanting)

    @property
    def torque(self) -> Array:
        """Shape (m, n) [Nm], |xi| I, signs as printed."""
        return self.experiment.torque_constant * self.current


@dataclass(frozen=True)
class Reconstruction:
    """One set of poses and points that reproduces Table 5; see the module's docstring. n joints, c configurations.

    Attributes:
        name: "A1", or family and number of an alternative.
        family: How it was found: which torque was held responsible for the deflection, and with which stiffness.
        q: Shape (c, n) [rad], one row per configuration.
        load_point: Shape (3,) [m], in the last frame.
        reflector: Shape (3,) [m], in the last frame; the measuring point.
        current_signs: Shape (n,), s_j in Gamma_j = s_j xi_j dI_j.
        assumed_stiffness: Shape (n,) [Nm/rad], held fixed or fitted in finding it.
    """

    name: str
    family: str
    q: Array
    load_point: Array
    reflector: Array
    current_signs: Array
    assumed_stiffness: Array

    def arm(self, experiment: Experiment) -> Arm:
        """Return the arm of Table 1 with the points "load" and "reflector" of this reconstruction."""
        points = {"load": self.load_point.tolist(), "reflector": self.reflector.tolist()}
        return Arm(bodies_from_table(experiment.rows, points))

    def readings(self, table: Table5) -> StaticReadings:
        """Return Table 5 as readings in these poses.

        There is one reflector, so there is no orientation. The motors are taken to hold the pose. Noise is nominal; the
        scatter of the deflections about straight lines over the load (`bench.identify.table5_lines`) bears it out.
        """
        series, experiment = table.configuration - 1, table.experiment
        force = np.where(table.hangs[:, None], -1.0, 1.0) * table.force
        return StaticReadings(
            series=series,
            is_reference=table.is_reference,
            q_motor=self.q[series],
            current_torque=-self.current_signs * experiment.torque_constant * table.current,
            reflectors=table.deflection[:, None],
            wrench=np.concatenate([force, np.zeros_like(force)], axis=1),
            is_vertical=table.hangs,
            n_repeats=np.full(len(series), experiment.repeats),
            sigma_current_torque=experiment.sigma_torque,
            sigma_reflector=experiment.sigma_reflector_m,
            sigma_wrench=experiment.sigma_wrench,
            reflector_names=("reflector",),
            load_point="load",
            systematic=Systematic(experiment.torque_gain),
        )


def read_table5(folder: Path) -> Table5:
    """Read `table5.csv` and `experiment.yaml` of a folder.

    Raises:
        InputError: A file is missing or not valid, or the table lacks a column.
    """
    rows = _rows(folder / "table5.csv")
    experiment = read_experiment(folder)
    currents = tuple(f"i{j}_A" for j in range(1, len(experiment.rows) + 1))
    columns = (("fx_N", "fy_N", "fz_N"), currents, ("dx_mm", "dy_mm", "dz_mm"))
    lacking = [name for names in (("configuration",), *columns) for name in names if name not in rows[0]]
    if lacking:
        raise InputError(f"{folder / 'table5.csv'}: columns are missing: {', '.join(lacking)}.")
    force, current, deflection = (np.array([[float(row[n] or 0) for n in names] for row in rows]) for names in columns)
    configuration = np.array([int(row["configuration"]) for row in rows])
    return Table5(experiment, configuration, force, current, MILLIMETRE * deflection)


def read_table6(folder: Path) -> dict[str, Array]:
    """Read `table6.csv` of a folder: the paper's stiffness by method, shape (n,) [Nm/rad].

    Raises:
        InputError: The file is missing.
    """
    rows = _rows(folder / "table6.csv")
    return {row.pop("method"): np.array([float(value) for value in row.values()]) for row in rows}


def read_reconstructions(folder: Path) -> tuple[Reconstruction, ...]:
    """Read `configurations.json` and `alternatives.json` of a folder, the named ones first.

    Raises:
        InputError: A file is missing.
    """
    named, other = (_json(folder / f"{name}.json") for name in ("configurations", "alternatives"))
    table6 = read_table6(folder)
    found = [_reconstruction(name, entry["note"], entry, table6["current"]) for name, entry in named.items()]
    for family, entries in other.items():
        found += [_reconstruction(f"{family}/{i}", family, entry, entry["k"]) for i, entry in enumerate(entries, 1)]
    return tuple(found)


def _reconstruction(
    name: str, family: str, entry: Mapping[str, Any], assumed_stiffness: Sequence[float] | Array
) -> Reconstruction:
    return Reconstruction(
        name=name,
        family=family,
        q=read_only(entry["q_deg"]) * DEGREE,
        load_point=read_only(entry["p_f_frame6_m"]),
        reflector=read_only(entry["p_m_frame6_m"]),
        current_signs=read_only(entry["current_signs"]),
        assumed_stiffness=read_only(assumed_stiffness),
    )


def _rows(file: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(text_of(file).splitlines()))


def _json(file: Path) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(text_of(file))
    return content
