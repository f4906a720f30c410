"""Where a search begins: what drawings leave out of a robot is found at once, for all of it is missing at once."""

from collections.abc import Collection, Hashable
from dataclasses import replace

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import Screening
from bench.diagnose.name.candidate_model import CandidateModel
from bench.diagnose.name.models import Fitter, Model, likeliest
from bench.diagnose.name.search_space import search_space
from bench.effects.catalogue import LEFT_OUT
from bench.effects.friction import CoulombFriction
from bench.executor.contract import Executor


def with_what_drawings_leave_out(
    linear: LinearisedModel, screening: Screening, nominal: Model, executor: Executor
) -> Model:
    """Return the model with all that nobody stated (`LEFT_OUT`), where that is the likelier one.

    About a model without any friction nothing else is linear, and one finding after the other is a round each. What is
    not needed of it the search takes back. Where a fit begins decides which optimum it ends in, for a first moment
    without a mass shows nothing: it is begun from what signatures say and from causes of no size.

    Args:
        linear: The campaign.
        screening: Everything that was tried.
        nominal: The nominal model; it is returned for a robot whose friction is stated.
        executor: Where to fit.
    """
    candidate = what_is_left_out(linear, screening, nominal)
    if not any(cause.effect.name == CoulombFriction.name for cause in candidate.causes):
        return nominal
    models = [nominal]
    for start in (candidate.start, {}):
        models += Fitter(linear, nominal.fit, executor, settles=False).fitted([replace(candidate, start=start)])
    return likeliest(models)


def what_is_left_out(
    linear: LinearisedModel, screening: Screening, nominal: Model, among: Collection[str] = LEFT_OUT
) -> CandidateModel:
    """Return all of it, to be fitted from what signatures say; of a cause with shapes, in the one that explains most.

    Args:
        linear: The campaign.
        screening: Everything that was tried.
        nominal: The nominal model.
        among: Names of the effects. A diagnosis does not begin with the gas of a counterbalance, which it finds by
            itself: on the KR300 its friction then ended as another law, which predicts axis 1 twice as badly.
    """
    about = search_space(linear, screening.tried, screening.threshold, nominal)
    rise = about.model.additions(())
    best: dict[Hashable, int] = {}
    for i in range(len(about.what)):
        cause = about.cause(i)
        if cause and cause.effect.name in among and rise[i] >= rise[best.get(cause.key, i)]:
            best[cause.key] = i
    return about.candidate_of(tuple(best.values()))
