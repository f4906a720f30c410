"""What the errors of a model itself do to what is fitted anew: its diagnosis knew its figures and findings to so much.

Of a parameter that is fitted anew, pi, the model has pi_m; it was pi_1 in the recordings that the model was made of and
is pi_2 in this one. With other figures off by e, a fit with gain K and sensitivities J finds

    pi_2 - pi_m + K J e + noise,

so both together, pi_2, err by K J e besides noise, and the difference of the recordings, pi_2 - pi_1, by
K J e + (pi_1 - pi_m). The posterior of the diagnosis says how e and pi_1 - pi_m vary together: what bends the model and
the fit alike cancels.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.given import DRIFTS, REACH, Posterior, PosteriorParameter, finding_on_top, sigma_about
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.simulations import simulate_all
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Effect
from bench.effects.payloads import UnstatedPayload
from bench.errors import BenchError
from bench.predict.another_payload import AnotherPayload
from bench.record.campaign import Array
from bench.robot.compiled import SpecEdit

NUDGE = 0.1  # rounding: of a standard deviation of a payload's size, for its derivative; a centre is a quotient


@dataclass(frozen=True, eq=False)
class ModelErrors:
    """Errors of a model about a recording; q parameters of its posterior.

    Attributes:
        root: Shape (q, q), of their covariance, in standard deviations of their priors.
        sensitivities: Shape (T, c, q), change of the readings with one of these.
        same: Name of a parameter that may be fitted anew -> shape (q,), by how much one of these is an error of it, of
            a figure in standard deviations of its prior, else SI.
    """

    root: Array
    sensitivities: Array
    same: Mapping[str, Array]

    def variances(self, linear: LinearisedModel, fit: Fit, freed: Collection[str]) -> tuple[Array, Array]:
        """Return what they add to the variance of the differences of a fit, and of both together, shape (p + k,) each.

        Of figures in standard deviations of their priors.

        Args:
            linear: The recording, with what is fitted.
            fit: Of what is free, and of what drifts, which has its errors in the model like all else.
            freed: Names of the figures that are free.
        """
        none = np.zeros(len(self.root))
        figures = [self.same.get(name, none) if name in freed else none for name in map(str, linear.nuisances)]
        own = np.stack([*figures, *(self.same.get(unknown.words, none) for unknown in fit.unknowns)])
        others = np.where(np.any(own != 0, axis=0), 0.0, self.sensitivities)
        tangent, bent = tangent_of(linear, fit), np.zeros_like(own)
        shows = tangent.jacobian[:, tangent.free]
        bent[tangent.free] = cho_solve(cho_factor(tangent.free_precision), shows.T @ linear.whiten(others))
        return _squares((bent + own) @ self.root), _squares(bent @ self.root)

    def rise(self, linear: LinearisedModel, fit: Fit) -> float:
        """Return by how much they raise the log evidence of a fit, for what it leaves may be these errors.

        With whitened changes E of what one standard deviation of each does, T the tangent of the fit, which is at its
        optimum, and H the precision of its parameters, all is Gaussian, and they are integrated out:
        b' A^-1 b / 2 - log det A / 2, where A = I + E'E - E'T H^-1 T'E and b = E'r, r what is left.

        Args:
            linear: The recording, with what is fitted.
            fit: Of what is free.
        """
        tangent = tangent_of(linear, fit)
        shows, errors = tangent.jacobian[:, tangent.free], linear.whiten(self.sensitivities) @ self.root
        both = shows.T @ errors
        precision = np.eye(errors.shape[1]) + errors.T @ errors
        precision -= both.T @ cho_solve(cho_factor(tangent.free_precision), both)
        pull = errors.T @ tangent.white
        determinant = float(np.linalg.slogdet(precision)[1])
        return 0.5 * (float(pull @ np.linalg.solve(precision, pull)) - determinant)


def model_errors(linear: LinearisedModel, posterior: Posterior) -> ModelErrors:
    """Return the errors of a model about a recording.

    Findings that do not edit the model are taken as they were found.

    Args:
        linear: The recording, linearised about the model, with all its figures.
        posterior: Of the diagnosis that handed the model over.
    """
    sensitivities = np.zeros((*linear.residual.shape, len(posterior.parameters)))
    same: dict[str, Array] = {}
    for i, name, share, change in _changes(linear, posterior):
        same.setdefault(name, np.zeros(len(posterior.parameters)))[i] = share
        sensitivities[:, :, i] += share * change
    root = np.asarray(np.linalg.cholesky(posterior.covariance), dtype=np.float64)
    return ModelErrors(root, sensitivities, same)


def _changes(linear: LinearisedModel, posterior: Posterior) -> Iterator[tuple[int, str, float, Array]]:
    """Yield index of a parameter, name of what it is an error of, by how much, and what one of that changes."""
    at = {str(one): i for i, one in enumerate(linear.nuisances)}
    found_friction = {_figure_of(one) for one in posterior.parameters if one.effect in DRIFTS}
    for i, one in enumerate(posterior.parameters):
        figure = at.get(_figure_of(one))
        if figure is not None:
            nuisance, change = linear.nuisances[figure], linear.sensitivities[:, :, figure]
            if one.effect and one.found:
                yield i, str(nuisance), one.sigma / one.found / nuisance.sigma, change
            elif not one.effect and str(nuisance) not in found_friction and one.unit == nuisance.unit:
                yield i, str(nuisance), 1.0 if nuisance.is_factor else sigma_about(one) / nuisance.sigma, change
        elif one.effect and one.effect != UnstatedPayload.name:
            reach = REACH * float(np.sqrt(posterior.covariance[i, i])) * one.sigma
            finding = finding_on_top(one, reach, linear.replay.compiled)
            moved = None if finding is None else _simulated(linear, finding)
            if moved is not None:
                yield i, one.name, 1.0, moved
    yield from _of_payload(linear, posterior)


def _figure_of(one: PosteriorParameter) -> str:
    """Return the name of the figure that a parameter is, or that a finding of friction is from then on."""
    return f"{DRIFTS[one.effect][0]} of {one.place}" if one.effect in DRIFTS else "" if one.effect else one.name


def _of_payload(linear: LinearisedModel, posterior: Posterior) -> Iterator[tuple[int, str, float, Array]]:
    """Yield the same of the sizes of a payload that was found, as errors of those of `AnotherPayload`."""
    sizes = {one.parameter: i for i, one in enumerate(posterior.parameters) if one.effect == UnstatedPayload.name}
    if not sizes or not posterior.parameters[sizes["mass"]].found:
        return
    mass, effect = posterior.parameters[sizes["mass"]], AnotherPayload()
    for parameter in effect.parameters:
        moment = f"moment_{parameter.name}"
        errors = {parameter.name: 1.0}
        if moment in sizes:  # of the centre s/m
            centre = posterior.parameters[sizes[moment]].found / mass.found
            errors = {moment: 1 / mass.found, "mass": -centre / mass.found}
        shares = {
            sizes[name]: x * posterior.parameters[sizes[name]].sigma for name, x in errors.items() if name in sizes
        }
        if not shares:
            continue
        step = NUDGE * max(abs(x) * float(np.sqrt(posterior.covariance[i, i])) for i, x in shares.items())
        change = _simulated(
            linear, Nuisance(parameter.name, parameter.unit, step, edit=_edit_of(effect, parameter.name))
        )
        if change is not None:
            for i, share in shares.items():
                yield i, f"{effect.title}: {parameter.name.replace('_', ' ')}", share, change / step


def _edit_of(effect: Effect, parameter: str) -> Callable[[float], SpecEdit]:
    """Return the change of a model in which one parameter of an effect on the whole robot is so large."""

    def edit(value: float) -> SpecEdit:
        changed = effect.edit(WHOLE, effect.complete({parameter: value}), Conditions.reference(0))
        return changed or (lambda spec, robot: None)

    return edit


def _simulated(linear: LinearisedModel, nuisance: Nuisance) -> Array | None:
    """Return what a standard deviation of something changes, shape (T, c); None where that cannot be simulated."""
    here, there = simulate_all(linear.replay, [NOMINAL, World({nuisance: nuisance.sigma})])
    return None if isinstance(here, BenchError) or isinstance(there, BenchError) else np.asarray(there - here)


def _squares(values: Array) -> Array:
    return np.asarray(np.sum(values**2, axis=1))
