"""The unknowns of the first pass in one vector."""

from dataclasses import dataclass

from bench.identify.dynamics.equations import DRIVE_COLUMNS, GAS_SHAPE
from bench.identify.dynamics.regressor import N_INERTIAL


@dataclass(frozen=True)
class Layout:
    """Where the unknowns stand in the vector of parameters.

    Attributes:
        n: Number of drives.
        has_payload: Whether an unstated payload is presumed.
        has_gas: Whether there is a counterbalance.
    """

    n: int
    has_payload: bool
    has_gas: bool

    @property
    def links(self) -> slice:
        """Inertial parameters of the links, 10 for each."""
        return slice(0, N_INERTIAL * self.n)

    @property
    def payload(self) -> slice:
        """Inertial parameters of the payload about the load point."""
        return self._after(self.links, N_INERTIAL * self.has_payload)

    @property
    def drives(self) -> slice:
        """Those of `DRIVE_COLUMNS`, drive after drive."""
        return self._after(self.payload, len(DRIVE_COLUMNS) * self.n)

    @property
    def gas(self) -> slice:
        """Gas amount, and errors of `GAS_SHAPE`."""
        return self._after(self.drives, (1 + len(GAS_SHAPE)) * self.has_gas)

    @property
    def softness(self) -> slice:
        """Stated stiffness of the gears over the true one."""
        return self._after(self.gas, self.n)

    @property
    def gain(self) -> slice:
        """Relative errors of the torques that are read."""
        return self._after(self.softness, self.n)

    @property
    def delay(self) -> int:
        """By how much the torques are later than the angles [s]."""
        return int(self.gain.stop)

    @property
    def size(self) -> int:
        """Number of parameters."""
        return self.delay + 1

    def of_drives(self, column: str) -> slice:
        """Return where one of `DRIVE_COLUMNS` stands, in the order of the drives."""
        first = self.drives.start + DRIVE_COLUMNS.index(column)
        return slice(first, self.drives.stop, len(DRIVE_COLUMNS))

    @staticmethod
    def _after(before: slice, count: int) -> slice:
        return slice(before.stop, before.stop + count)
