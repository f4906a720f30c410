"""Plain least squares of base inertial parameters, friction, offsets and gas: what every verdict has to beat."""

from dataclasses import dataclass

import numpy as np

from bench.identify.dynamics.base_parameters import BaseParameters
from bench.identify.dynamics.normal import Normal
from bench.identify.dynamics.parameters import Layout
from bench.record.campaign import Array

FRICTION = ("coulomb", "viscous", "offset")
# derived: of the column-scaled regression, beyond which directions are left at zero; ten times what Gautier allows
CONDITION = 1e3


@dataclass(frozen=True)
class Rival:
    """The problem that plain least squares solves: parameters = `spread` times its unknowns; no prior, no gain."""

    spread: Array

    def fit(self, normal: Normal) -> Array:
        """Return the parameters with the smallest weighted residual, shape (p,); of several, the shortest."""
        gram = self.spread.T @ normal.gram @ self.spread
        diagonal = np.diag(gram)
        scale = np.where(diagonal > 0, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)
        values, vectors = np.linalg.eigh(gram * np.outer(scale, scale))
        told = values > values.max(initial=0.0) / CONDITION**2
        inverse = np.where(told, 1 / np.where(told, values, 1.0), 0.0)
        unknowns = scale * (vectors @ (inverse * (vectors.T @ (scale * (self.spread.T @ normal.right)))))
        return np.asarray(self.spread @ unknowns)


def rival_of(layout: Layout, base: BaseParameters) -> Rival:
    """Return the plain problem of a robot."""
    friction = [np.arange(layout.size)[layout.of_drives(name)] for name in FRICTION]
    every = np.arange(layout.size)
    loads = [every[one] for one in layout.payloads] if layout.carried else []  # one alone is in the base parameters
    return Rival(np.eye(layout.size)[:, np.concatenate([base.lead, *loads, *friction, every[layout.gas][:1]])])
