"""How much an instrument scatters: by the campaign's own word, by the robot's figures, and by the data themselves."""

import numpy as np

from bench.diagnose.quantities import Quantity
from bench.record.campaign import Array, Campaign, Run
from bench.robot.figures import Figures, TorqueSensor, Tracker

NORMAL_MAD = 1.4826  # standard deviation of a normal distribution by its median absolute deviation
UNIFORM = 1 / np.sqrt(12)  # standard deviation of rounding to 1


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
        self._area = figures.instruments.pressure.piston_area_m2 if figures.instruments.pressure else None

    def of(self, quantity: Quantity, values: Array, run: Run) -> Array:
        """Return the noise of one reading at each of some values of a run, same shape."""
        if quantity.kind in self._given:
            return np.full_like(values, self._given[quantity.kind])
        instruments = self._instruments
        sigma = 0.0
        match quantity.kind:
            case "current":
                sigma = instruments.current.sigma_a if instruments.current else 0.02
            case "tau_motor":
                sigma = torque_sigma(instruments.torque, quantity.index) if instruments.torque else 0.0
            case "reflector":
                tracker = instruments.tracker
                sigma = tracker.sigma_per_distance * _distance(run, quantity.index, tracker) if tracker else 30e-6
                if quantity.index > 0 and tracker:
                    sigma = float(np.hypot(sigma, tracker.placement_sigma_m))
            case "q_link":
                sigma = 1e-6
            case "force":
                sigma = instruments.force.sigma_n if instruments.force else 0.5
            case "moment":
                sigma = instruments.force.sigma_nm if instruments.force else 0.2
            case _:
                sigma = 0.0
        full: Array = np.full_like(values, sigma)
        return full

    def rounding(self, quantity: Quantity) -> float:
        """Return what does not average out because readings are rounded coarsely."""
        if quantity.kind == "gas_pressure" and self._instruments.pressure:
            return float(UNIFORM * self._instruments.pressure.resolution_pa)
        return 0.0

    def lasting(self, quantity: Quantity) -> float:
        """Return what does not average out because it is the same in neighbouring samples."""
        fitted = self._instruments.link_encoder
        return fitted.accuracy_rad if quantity.kind == "q_link" and fitted else 0.0

    @staticmethod
    def of_samples(values: Array) -> float:
        """Return the scatter of a smooth signal's samples, from their third differences; robust against jumps."""
        if len(values) < 8:
            return 0.0
        third = np.diff(values, 3)
        return float(NORMAL_MAD * np.median(np.abs(third - np.median(third))) / np.sqrt(20.0))


def torque_sigma(sensor: TorqueSensor, drive: int) -> float:
    """Return the noise of the torque that one drive reports [Nm]."""
    values = np.atleast_1d(np.array(sensor.sigma_nm, dtype=np.float64))
    return float(values[drive if len(values) > 1 else 0])


def _distance(run: Run, reflector: int, tracker: Tracker) -> float:
    """Return the mean distance of a reflector from the tracker over a run [m]."""
    seen = run.stack(f"reflector_{reflector + 1}", "m", ("x", "y", "z"))
    return float(np.nanmean(np.linalg.norm(seen - np.array(tracker.position_m), axis=1)))
