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
        carried: Recordings that carry a payload each; empty: one payload in all.
    """

    n: int
    has_payload: bool
    has_gas: bool
    carried: tuple[str, ...] = ()

    @property
    def links(self) -> slice:
        """Inertial parameters of the links, 10 for each."""
        return slice(0, N_INERTIAL * self.n)

    @property
    def payloads(self) -> tuple[slice, ...]:
        """Inertial parameters of each payload about the load point, in the order of the recordings that carry them."""
        count = max(1, len(self.carried)) * self.has_payload
        return tuple(self._after(slice(0, self.links.stop + N_INERTIAL * k), N_INERTIAL) for k in range(count))

    @property
    def payload(self) -> slice:
        """Those of the payload that is there now, which the last recording carries."""
        return self.payloads[-1] if self.has_payload else self._after(self.links, 0)

    def payload_in(self, recording: str) -> slice:
        """Return those of the payload that a recording carries; of one that was not fitted, what is there now."""
        return self.payloads[self.carried.index(recording)] if recording in self.carried else self.payload

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
    def lean(self) -> slice:
        """How far gravity leans towards either direction across the model's [rad]."""
        return self._after(self.softness, 2)

    @property
    def gain(self) -> slice:
        """Relative errors of the torques that are read."""
        return self._after(self.lean, self.n)

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
