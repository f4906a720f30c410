"""What a diagnosis knows of figures and findings, together: the prior of the next one (`--given`)."""

import numpy as np

from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.cross_validation.jackknife import jackknife_covariance
from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.given import Posterior, PosteriorParameter
from bench.effects.fitted import entry_of

WIDER = 1 + 1e-6  # rounding: times a variance; more than that was counted with it


def posterior_of(linear: LinearisedModel, fit: Fit) -> Posterior:
    """Return what a fit knows, shapes of findings and what belongs to the campaign alone integrated out.

    Where the fit counts how runs disagree about the sizes of its findings (`jackknife.py`), so does all that is known
    here, together: figures and sizes that stand for one another move together from run to run, and what they predict
    hardly does.

    Args:
        linear: The campaign.
        fit: To all of it.
    """
    tangent, p = tangent_of(linear, fit), len(fit.nuisances)
    covariance = np.linalg.inv(tangent.precision)
    if np.any(np.diag(fit.covariance) > WIDER * np.diag(covariance)[p:]):
        covariance += jackknife_covariance(tangent, *folds_of(linear).of_rows(linear))
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
