"""What the paper checks: that M depends on the angle alone, and that C and l_c predict it elsewhere."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.identify.balancing_torque import BalancingTorque
from bench.identify.counterbalance_fit import CounterbalanceFit
from bench.record.campaign import Array

GRID = np.deg2rad(0.5)  # [rad], step of the angles at which traverses are compared
SMOOTH = 7  # degree of the polynomial whose root is where M vanishes


@dataclass(frozen=True)
class Spread:
    """M of several traverses at common angles.

    Attributes:
        theta: Shape (T,) [rad], angles that all have passed.
        torque: Shape (runs, T) [Nm].
    """

    theta: Array
    torque: Array

    @property
    def mean(self) -> Array:
        """Shape (T,) [Nm], over the traverses."""
        mean: Array = self.torque.mean(axis=0)
        return mean

    @property
    def largest(self) -> float:
        """Largest departure of a traverse from the mean of all, as a share of the largest |M|: M itself passes zero."""
        return float(np.abs(self.torque - self.mean).max() / np.abs(self.mean).max())

    @property
    def zero(self) -> float:
        """Angle at which the mean vanishes [rad], nan if it keeps its sign: root of a polynomial through all angles."""
        roots = np.polynomial.Polynomial.fit(self.theta, self.mean, SMOOTH).roots()
        inside = [r.real for r in roots if abs(r.imag) < GRID and self.theta[0] <= r.real <= self.theta[-1]]
        return float(inside[0]) if len(inside) == 1 else float("nan")


def spread(torques: Sequence[BalancingTorque]) -> Spread:
    """Return M of all traverses at common angles.

    Raises:
        InputError: They have no angle in common.
    """
    low, high = max(t.theta.min() for t in torques), min(t.theta.max() for t in torques)
    if not low < high:
        raise InputError("the traverses have no angle in common; sweep the same range at every speed and payload.")
    theta = np.arange(low, high, GRID)
    return Spread(theta, np.stack([np.interp(theta, t.theta, t.torque) for t in torques]))


@dataclass(frozen=True)
class Prediction:
    """M of one traverse that the fit has not seen, beside what C and l_c predict.

    Attributes:
        name: Of the traverse.
        theta: Shape (B,) [rad].
        measured: Shape (B,) [Nm], M of Eq. (32) with the torque constant as it stands in the figures.
        corrected: Shape (B,) [Nm], M less what the fit found the torque constant and other nuisances to be wrong by.
        predicted: Shape (B,) [Nm], Eq. (11).
        by_spring: Shape (B,) [Nm], by the linear spring that fits the same data best.
    """

    name: str
    theta: Array
    measured: Array
    corrected: Array
    predicted: Array
    by_spring: Array

    @property
    def error(self) -> float:
        """Largest error as a share of the largest |M| measured."""
        return self._share(self.predicted - self.measured)

    @property
    def corrected_error(self) -> float:
        """The same with nuisances corrected."""
        return self._share(self.predicted - self.corrected)

    @property
    def spring_error(self) -> float:
        """The same for the linear spring."""
        return self._share(self.by_spring - self.measured)

    def _share(self, error: Array) -> float:
        return float(np.abs(error).max() / np.abs(self.measured).max())


def predict(fit: CounterbalanceFit, torques: Sequence[BalancingTorque]) -> tuple[Prediction, ...]:
    """Return the prediction of each traverse; angles at which the identified gas would have no volume give nan."""
    law, found = fit.counterbalance, np.array(list(fit.nuisances.values()))
    return tuple(
        Prediction(
            name=t.name,
            theta=t.theta,
            measured=t.torque,
            corrected=t.torque - t.sensitivity @ found,
            predicted=law.torque(t.theta),
            by_spring=fit.spring.torque(t.theta, fit.geometry),
        )
        for t in torques
    )
