"""A predicted displacement along a line against the measured one: how far off it is, and how far off it may be."""

from dataclasses import dataclass

import numpy as np

from bench.identify.line_deflection import Prediction
from bench.identify.line_passes import AXES
from bench.robot.bodies import Array

DRAWS = 1000
LEVEL = 0.95


@dataclass(frozen=True)
class AxisComparison:
    """Measured less predicted along one axis.

    Attributes:
        axis: "x", "y" or "z".
        rms: Root mean square [m].
        maximum: Largest magnitude [m].
        rms_allowed: [m], the rms stays below with 95 % probability if the estimate is as good as its covariance says.
        maximum_allowed: [m], the same for the largest magnitude.
        noise: Part of the rms that is noise of tracker and torques [m].
        mean: Mean [m].
        mean_error: Standard error of the mean [m].
        ratio: Predicted over measured displacement, least squares through the origin along the line.
        ratio_error: Standard error of the ratio.
    """

    axis: str
    rms: float
    maximum: float
    rms_allowed: float
    maximum_allowed: float
    noise: float
    mean: float
    mean_error: float
    ratio: float
    ratio_error: float

    @property
    def as_expected(self) -> bool:
        """Whether the rms is no larger than the covariance of the estimate and the noise allow."""
        return self.rms <= self.rms_allowed


def compare(
    measured: Array, sigma: Array, predicted: Prediction, rng: np.random.Generator
) -> tuple[AxisComparison, ...]:
    """Return one comparison per axis.

    Errors of the estimate are common to all places, noise is not. What they allow together is drawn, since the
    largest of many correlated errors has no handy distribution.

    Args:
        measured: Shape (T, 3) [m].
        sigma: Shape (3,) [m], noise of one measured displacement.
        predicted: The prediction.
        rng: Source of the draws.
    """
    off = measured - predicted.displacement
    noise = np.hypot(sigma, predicted.noise)
    drawn = _draw(predicted.covariance, rng)
    results = []
    for a, axis in enumerate(AXES):
        by_estimate = drawn @ predicted.per_parameter[:, a].T
        allowed = np.abs(by_estimate + noise[:, a] * rng.standard_normal(by_estimate.shape))
        mean_way = predicted.per_parameter[:, a].mean(axis=0)
        m, p = measured[:, a], predicted.displacement[:, a]
        size = float(m @ m) or np.nan  # nothing moved along this axis
        ratio_way = m @ predicted.per_parameter[:, a] / size
        results.append(
            AxisComparison(
                axis=axis,
                rms=_rms(off[:, a]),
                maximum=float(np.max(np.abs(off[:, a]))),
                rms_allowed=float(np.quantile(np.sqrt(np.mean(allowed**2, axis=1)), LEVEL)),
                maximum_allowed=float(np.quantile(allowed.max(axis=1), LEVEL)),
                noise=_rms(noise[:, a]),
                mean=float(off[:, a].mean()),
                mean_error=float(
                    np.sqrt(mean_way @ predicted.covariance @ mean_way + np.mean(noise[:, a] ** 2) / len(off))
                ),
                ratio=float(m @ p) / size,
                ratio_error=float(
                    np.sqrt(ratio_way @ predicted.covariance @ ratio_way + np.mean(noise[:, a] ** 2) / size)
                ),
            )
        )
    return tuple(results)


def _draw(covariance: Array, rng: np.random.Generator) -> Array:
    """Return draws from a normal distribution, shape (DRAWS, p); the covariance may be singular."""
    scale = np.sqrt(np.diag(covariance))
    scale = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.asarray(rng.standard_normal((DRAWS, len(scale))) @ root.T * scale)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
