"""What precision to expect from a set of planned visits.

Everything is said of the *relative* compliances N_j / N_j,guess; their standard errors are those of the relative
stiffness to first order. The n-th root of the determinant of their information counts measurements: a set with twice
the D-efficiency of another does with half as many repeats.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.gls import SURE
from bench.identify.load_axis import on_axis_sentence, turned_by_load
from bench.identify.outcome import condition_number, excludes_rigid
from bench.identify.pose_plan import PLANNED, PlannedMethod, Setup, Visits, information
from bench.robot.bodies import Array, read_only

GUESS = 1.0  # relative standard deviation of the guessed compliances: wide, but enough to start a choice from


@dataclass(frozen=True)
class Precision:
    """What a set of visits will tell about the stiffness.

    Attributes:
        joint_names: Length n.
        stiffness: Shape (n,) [Nm/rad], the guess.
        information: Shape (n, n), about the relative compliances, the method's nuisances unknown within their priors.
        gain: Shape (n, n), relative covariance by gain errors, which no choice of poses reveals.
        turned: Shape (n,) bool, joints that a load turns in some pose.
    """

    joint_names: tuple[str, ...]
    stiffness: Array
    information: Array
    gain: Array
    turned: NDArray[np.bool_]

    @property
    def observable(self) -> NDArray[np.bool_]:
        """Shape (n,) bool: joints of which these visits will exclude that they are rigid."""
        covariance = np.array(np.linalg.inv(self.information + np.eye(len(self.stiffness)) / GUESS**2))
        return excludes_rigid(np.ones_like(self.stiffness), covariance)

    @property
    def covariance(self) -> Array:
        """Shape (n, n), of the relative compliances, by instrument noise; nan where not observable."""
        seen = np.ix_(self.observable, self.observable)
        covariance = np.full_like(self.information, np.nan)
        covariance[seen] = np.linalg.inv(self.information[seen])
        return covariance

    @property
    def standard_error(self) -> Array:
        """Shape (n,) [Nm/rad], of each k, by instrument noise; nan where not observable."""
        return self.stiffness * np.sqrt(np.diag(self.covariance))

    @property
    def total_standard_error(self) -> Array:
        """Shape (n,) [Nm/rad], of each k, with the gain errors."""
        return self.stiffness * np.sqrt(np.diag(self.covariance + self.gain))

    @property
    def condition_number(self) -> float:
        """Of the column-scaled regressor over the observable joints."""
        return condition_number(self.information[np.ix_(self.observable, self.observable)])

    def efficiency(self, reference: "Precision") -> float:
        """Return the D-efficiency against another set: (det / its det)^(1/n) over the joints that both observe.

        0 where the other observes a joint that this one does not, inf the other way round, nan where both.
        """
        lacks = bool(np.any(reference.observable & ~self.observable))
        adds = bool(np.any(self.observable & ~reference.observable))
        if lacks or adds:
            return np.nan if lacks and adds else 0.0 if lacks else np.inf
        seen = np.ix_(self.observable, self.observable)
        ours, other = (np.linalg.slogdet(precision.information[seen])[1] for precision in (self, reference))
        return float(np.exp((ours - other) / np.sum(self.observable)))

    @property
    def notes(self) -> tuple[str, ...]:
        """One sentence for each joint that these visits will not tell about."""
        return tuple(
            f"{name} will not be observable: the loads put too little torque on it; allow slanting loads or more poses."
            if turned
            else f"{name} will not be observable. {on_axis_sentence(name)}"
            for name, seen, turned in zip(self.joint_names, self.observable, self.turned, strict=True)
            if not seen
        )


def expected_precision(setup: Setup, visits: Visits, method: str) -> Precision:
    """Return what a set of visits will tell about the stiffness by a method (a key of `PLANNED`)."""
    n = setup.arm.n_joints
    total = information(setup, visits, PLANNED[method]).sum(axis=0) + prior_information(setup, PLANNED[method], np.inf)
    shared = total[:n, n:]
    relative = 1 / setup.compliance
    gain = PLANNED[method].gain_covariance(setup) * np.outer(relative, relative)
    return Precision(
        joint_names=setup.arm.joint_names,
        stiffness=read_only(relative),
        information=read_only(total[:n, :n] - shared @ np.linalg.solve(total[n:, n:], shared.T)),
        gain=read_only(gain),
        turned=turned_by_load(setup.arm, setup.load_point),
    )


def prior_information(setup: Setup, method: PlannedMethod, guess: float = GUESS) -> Array:
    """Return what is known beforehand of the relative compliances and the nuisances, shape (p, p).

    Args:
        setup: What is the same at every pose.
        method: Method of identification.
        guess: Relative standard deviation of the guessed compliances; inf for none.
    """
    nuisance = np.maximum(method.nuisance_sigma(setup), SURE)
    return np.diag(np.concatenate([np.full(setup.arm.n_joints, guess), nuisance]) ** -2.0)
