"""What a diagnosis knows of figures and findings, together: the prior of the next one (`--given`)."""

import numpy as np

from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.given import Posterior, PosteriorParameter
from bench.effects.fitted import entry_of


def posterior_of(linear: LinearisedModel, fit: Fit) -> Posterior:
    """Return what a fit knows, shapes of findings and what belongs to the campaign alone integrated out.

    Sizes of findings are as uncertain as the fit states them, which may count how runs disagree (`jackknife.py`).

    Args:
        linear: The campaign.
        fit: To all of it.
    """
    covariance = np.linalg.inv(tangent_of(linear, fit).precision)
    p = len(fit.nuisances)
    more = np.diag(fit.covariance) - np.diag(covariance)[p:]
    covariance[p:, p:] += np.diag(np.maximum(more, 0.0))
    found, which, width = [], [], []
    for i, nuisance in enumerate(linear.nuisances):
        if nuisance.is_simulated and nuisance.recording is None:
            value = float(fit.nuisances[i]) * nuisance.sigma
            before = nuisance.earlier.found if nuisance.earlier else 0.0
            found.append(PosteriorParameter(nuisance.name, nuisance.unit, nuisance.sigma, value, before=before))
            which.append(i)
            width.append(1.0)
    for j, unknown in enumerate(fit.unknowns):
        if unknown.cause.place.recording is not None:
            continue
        entry = entry_of(unknown.cause.acting({unknown.parameter.name: float(fit.values[j])}))
        if entry is None or unknown.parameter.is_shape or entry.form:
            continue
        name = f"{unknown.cause}: {unknown.parameter.name}, as found before"
        known = (name, unknown.parameter.unit, unknown.sigma, float(fit.values[j]))
        shapes = {
            u.parameter.name: float(v)
            for u, v in zip(fit.unknowns, fit.values, strict=True)
            if u.cause is unknown.cause and u.parameter.is_shape
        }
        found.append(PosteriorParameter(*known, entry.effect, entry.place, unknown.parameter.name, shapes))
        which.append(p + j)
        width.append(unknown.sigma)
    scale = np.array(width)
    return Posterior(tuple(found), covariance[np.ix_(which, which)] / np.outer(scale, scale))
