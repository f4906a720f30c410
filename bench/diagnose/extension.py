"""The model that is handed over: what was found, as a robot can have it."""

from bench.diagnose.cross_validation.held_out import CONFIRMS, held_out
from bench.diagnose.cross_validation.jackknife import with_jackknife
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.discrepancy import Discrepancy
from bench.diagnose.name.models import Model, likeliest
from bench.diagnose.name.naming import Naming
from bench.diagnose.replay.instants import recordings_of
from bench.diagnose.verdict import CONFIRMED


def extension_of(naming: Naming, discrepancy: Discrepancy | None) -> Fit | None:
    """Return the model with what was found, listed or learned; None where there is nothing to add.

    What is handed over is fitted as it is handed over. A robot has no place for an error of its recording: what such
    an error took of a misfit is missing there. Confirmed, it belongs to the channel; where most searches do not find it
    again, what is left is fitted without it. Of several recordings the one that it is in has to be searched to find it.
    Listed causes may stand in the place of a shape that no model runs with (`standing_in`).
    """
    if discrepancy and discrepancy.is_gain:
        return discrepancy.fit
    best = naming.models[0] if naming.models else None
    if best is None or not best.keys:
        return None
    linear, is_one = naming.linear, len(recordings_of(naming.linear.segments)) < 2
    doubtful = {one.cause.key for one in naming.findings if is_one and one.repeats < CONFIRMED}
    causes = tuple(one for one in best.causes if one.effect.level == "machine" or one.key not in doubtful)
    if best.shape is None and causes == best.causes:
        return best.fit
    fit = _fit_of(linear, best, causes)
    return standing_in(naming, fit) if best.shape else fit


def standing_in(naming: Naming, fit: Fit | None) -> Fit | None:
    """Return the likeliest model of listed causes alone, where it predicts surely better than a fit; else that fit.

    They are not all that acts there, but predict it. A torque over the speed holds what Coulomb friction and a little
    more do: of a real arm the robot without either left 10 Nm of 41, and leaves 2.7 with the listed causes that had
    fallen behind by 70 nats of 4500. A channel may become less probable by what is not worth a mention: of that arm,
    beside 7600 nats, a wrist lost 0.15. Errors of a recording are those of the fit: a robot has no place for others.

    Args:
        naming: What the data say, with a free shape that is not handed over.
        fit: Of the listed causes of the best model, without the shape; None: there are none.
    """
    rivals = [model for model in naming.models if model.shape is None]
    if not rivals:
        return fit
    rival, mine = likeliest(rivals), {cause.key for cause in fit.causes} if fit else set()
    causes = tuple(one for one in rival.causes if one.effect.level == "machine" or one.key in mine)
    if {cause.key for cause in causes} <= mine:
        return fit
    other, before = _fit_of(naming.linear, rival, causes), fit or naming.null
    return other if other and held_out(naming.linear, before, other).predicts_better(CONFIRMS) else fit


def _fit_of(linear: LinearisedModel, model: Model, causes: tuple[Cause, ...]) -> Fit | None:
    """Return a fit of some of the listed causes of a model alone; None of none."""
    if not causes:
        return None
    if model.shape is None and causes == model.causes:
        return with_jackknife(linear, model.fit)
    beside = model.listed_fit(linear)
    known = beside if causes == beside.causes else None
    return with_jackknife(linear, refit(linear, causes, beside.start, beside.nuisances, known))
