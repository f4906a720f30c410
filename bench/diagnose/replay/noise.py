"""How much an instrument scatters: by the campaign's own word, by the robot's figures, and by the data themselves."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.quantities import Quantity
from bench.record.campaign import Array, Campaign, Run
from bench.record.scatter import scatter_of_samples
from bench.robot.figures import Figures
from bench.robot.instruments import CurrentSensor, ForceSensor, TorqueSensor, Tracker

FEWEST = 8  # declared: samples in a group, in which a scatter about a parabola can be seen
MOST_ALIKE = 0.8  # assumed: correlation of neighbours that is believed; beyond it samples are a slow signal, not noise
# assumed: [K]; by which gas and the wall around it drift with the air of a workshop over hours
GAS_DRIFT_K = 1.0
UNIFORM = 1 / np.sqrt(12)  # exact: standard deviation of rounding to 1
# derived: [m], noise of a tracker that the figures do not have: 10 um/m (its default) at 3 m
UNSTATED_M = 30e-6
LINK_ENCODER = 1e-6  # assumed: [rad] or [m], noise of a secondary encoder, at least: a fifth of an arcsecond
# Instruments that the figures do not have scatter as such instruments do by default.
UNSTATED_CURRENT, UNSTATED_FORCE = CurrentSensor.model_validate({}), ForceSensor.model_validate({})


class Noise:
    """Standard deviations of single readings.

    Args:
        campaign: Its manifest may give noise.
        figures: Of the robot.
    """

    def __init__(self, campaign: Campaign, figures: Figures) -> None:
        self._given = campaign.noise
        self._instruments = figures.instruments
        self._constants = [drive.torque_constant_nm_per_a for drive in figures.drives]

    def of(self, quantity: Quantity, values: Array, run: Run) -> Array:
        """Return the noise of one reading at each of some values of a run, same shape."""
        if quantity.kind in self._given:
            return np.full_like(values, self._given[quantity.kind])
        instruments = self._instruments
        match quantity.kind:
            case "current":
                sigma = (instruments.current or UNSTATED_CURRENT).sigma_a
            case "tau_motor":
                sigma = torque_sigma(instruments.torque, quantity.index) if instruments.torque else 0.0
            case "reflector":
                tracker = instruments.tracker
                sigma = UNSTATED_M
                if tracker:
                    sigma = tracker.sigma_per_distance * _distance(run, quantity.index, tracker)
                if quantity.index > 0 and tracker:
                    sigma = float(np.hypot(sigma, tracker.placement_sigma_m))
            case "q_link":
                sigma = LINK_ENCODER
            case "force":
                sigma = (instruments.force or UNSTATED_FORCE).sigma_n
            case "moment":
                sigma = (instruments.force or UNSTATED_FORCE).sigma_nm
            case _:
                sigma = 0.0
        return np.full_like(values, sigma)

    def beside(self, quantity: Quantity, values: Array, run: Run, scatter: float) -> Array:
        """Return the noise of one reading at each of some values, same shape: as stated, or as its samples scatter.

        Args:
            quantity: What was read.
            values: Where.
            run: Of which.
            scatter: Of the samples, 0 where nobody can say; where it is more than stated, or nothing was, it counts.
        """
        if scatter > 0 and not self.is_stated(quantity):
            return np.full_like(values, scatter)
        return np.maximum(self.of(quantity, values, run), scatter)

    def is_stated(self, quantity: Quantity) -> bool:
        """Whether anybody stated what a drive's sensor scatters; a default that nobody looked at says nothing."""
        if quantity.kind in self._given or quantity.kind != "current":
            return True
        sensor = self._instruments.current
        return sensor is not None and "sigma_a" in sensor.model_fields_set

    def rounding(self, quantity: Quantity) -> float:
        """Return what does not average out because readings are rounded coarsely."""
        if quantity.kind == "gas_pressure" and self._instruments.pressure:
            return float(UNIFORM * self._instruments.pressure.resolution_pa)
        return 0.0

    def lasting(self, quantity: Quantity) -> float:
        """Return what does not average out because it is the same in neighbouring samples."""
        if quantity.kind == "gas_temperature":
            return GAS_DRIFT_K
        fitted = self._instruments.link_encoder
        return fitted.accuracy_rad if quantity.kind == "q_link" and fitted else 0.0

    @staticmethod
    def of_samples(values: Array) -> Array:
        """Return the scatter of smooth signals' samples, from their third differences; robust against jumps.

        Args:
            values: Shape (rows, c).

        Returns:
            Shape (c,).
        """
        if len(values) < FEWEST:
            return np.zeros(values.shape[1])
        return scatter_of_samples(values)

    @staticmethod
    def of_groups(values: Array, groups: Sequence[NDArray[np.int64]]) -> Array:
        """Return the scatter of samples about a parabola through each group of them, as of white noise.

        Third differences see what changes from sample to sample; this sees all that a group averages, such as torque
        that rings, and takes into account that neighbours ring alike.

        Args:
            values: Shape (rows, c).
            groups: Rows that follow each other.

        Returns:
            Shape (c,).
        """
        sizes = [len(group) for group in groups]
        n = int(np.quantile(sizes, 0.5, method="lower")) if sizes else 0  # the size of a group, not between two
        if n < FEWEST:
            return np.zeros(values.shape[1])
        samples = np.stack([values[group] for group in groups if len(group) == n]).transpose(0, 2, 1)
        basis = _orthonormal_parabolas(n)
        left = samples - samples @ basis @ basis.T
        power = np.median(np.sum(left**2, axis=2), axis=0)
        follows = np.median(np.sum(left[:, :, 1:] * left[:, :, :-1], axis=2), axis=0)
        alike = np.clip(follows / np.maximum(power, 1e-300), 0.0, MOST_ALIKE)
        scatter: Array = np.sqrt(power / (n - 3) * (1 + alike) / (1 - alike))
        return scatter


@lru_cache
def _orthonormal_parabolas(n: int) -> Array:
    """Return an orthonormal basis of the parabolas over n samples, shape (n, 3)."""
    basis: Array = np.linalg.qr(np.vander(np.linspace(-1, 1, n), 3))[0]
    return basis


def torque_sigma(sensor: TorqueSensor, drive: int) -> float:
    """Return the noise of the torque that one drive reports [Nm]."""
    values = np.atleast_1d(np.array(sensor.sigma_nm, dtype=np.float64))
    return float(values[drive if len(values) > 1 else 0])


def _distance(run: Run, reflector: int, tracker: Tracker) -> float:
    """Return the mean distance of a reflector from the tracker over a run [m], along the axes that were read."""
    seen = run.stack(f"reflector_{reflector + 1}", "m", ("x", "y", "z"))
    return float(np.mean(np.linalg.norm(np.nan_to_num(seen - np.array(tracker.position_m)), axis=1)))
