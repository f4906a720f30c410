"""The loading experiment behind Table 5: the arm by its own tables, and how well its instruments read."""

from pathlib import Path

import numpy as np
from pydantic import Field, ValidationError

from bench.errors import InputError
from bench.identify.denavit_hartenberg import Row
from bench.record.strict import Strict
from bench.record.yaml_text import YamlFault, load_typed_yaml
from bench.robot.bodies import Array, read_only
from bench.robot.bounds import NonNegative, Positive
from bench.robot.folder import problems_of

FILE = "experiment.yaml"


class TableRow(Strict):
    """One line of a modified Denavit-Hartenberg table, Table 1; the links carry no mass.

    Gravity stiffness and k_b change the results by less than 0.5 %, two orders below what the poses leave open.
    """

    a_m: float
    alpha_deg: float
    d_m: float
    zero_deg: float = Field(description="angle of the table where the joint reads zero")
    limits_deg: tuple[float, float]

    def in_radians(self) -> Row:
        """Return the line with its angles in radians."""
        degree = np.pi / 180
        low, high = (limit * degree for limit in self.limits_deg)
        return Row(self.a_m, self.alpha_deg * degree, self.d_m, self.zero_deg * degree, (low, high))


class Experiment(Strict):
    """Contents of `experiment.yaml`; n joints."""

    denavit_hartenberg: tuple[TableRow, ...] = Field(min_length=1)
    torque_constant_nm_per_a: tuple[Positive, ...] = Field(description="xi, one per joint, Table 2")
    torque_constant_error: NonNegative = Field(description="relative standard deviation of xi")
    repeats: int = Field(gt=0)
    sigma_current_a: Positive = Field(description="of one reading, before rounding")
    resolution_current_a: NonNegative = Field(description="of a current as printed")
    current_gain_sigma: NonNegative = Field(description="relative standard deviation of a current's gain")
    sigma_reflector_m: Positive = Field(description="of one reading of one coordinate")
    sigma_force_n: Positive
    sigma_moment_nm: Positive

    @property
    def rows(self) -> tuple[Row, ...]:
        """The table, base first."""
        return tuple(row.in_radians() for row in self.denavit_hartenberg)

    @property
    def torque_constant(self) -> Array:
        """Shape (n,) [Nm/A]."""
        return read_only(self.torque_constant_nm_per_a)

    @property
    def sigma_torque(self) -> Array:
        """Shape (n,) [Nm], standard deviation of one current as printed, as torque."""
        return self.torque_constant * float(np.hypot(self.sigma_current_a, self.resolution_current_a / np.sqrt(12)))

    @property
    def sigma_wrench(self) -> Array:
        """Shape (6,) [N, Nm], standard deviation of one reading."""
        return read_only([self.sigma_force_n] * 3 + [self.sigma_moment_nm] * 3)

    @property
    def torque_gain(self) -> Array:
        """Shape (n,), relative standard deviation of what a current is taken for."""
        error = np.hypot(self.torque_constant_error, self.current_gain_sigma)
        return np.full(len(self.torque_constant_nm_per_a), error)


def read_experiment(folder: Path) -> Experiment:
    """Read `experiment.yaml` of a folder.

    Raises:
        InputError: The file is missing, or breaks the schema; every fault is listed.
    """
    file = folder / FILE
    try:
        return Experiment.model_validate(load_typed_yaml(file))
    except YamlFault as fault:
        raise InputError(f"{file}: {fault}; {fault.remedy}.") from fault
    except ValidationError as error:
        raise InputError(problems_of(error, file.name, Experiment)) from error


def text_of(file: Path) -> str:
    """Return the text of one of the paper's files.

    Raises:
        InputError: The file is missing.
    """
    if not file.is_file():
        raise InputError(f"{file}: no such file; give the folder with the paper's tables.")
    return file.read_text(encoding="utf-8")
