"""Where a search begins: what drawings leave out of a robot is found at once, for all of it is missing at once."""

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import Screening
from bench.diagnose.name.models import Fitter, Model
from bench.diagnose.name.search_space import search_space
from bench.effects.catalogue import LEFT_OUT
from bench.effects.friction import CoulombFriction
from bench.executor.contract import Executor


def with_what_drawings_leave_out(
    linear: LinearisedModel, screening: Screening, nominal: Model, executor: Executor
) -> Model:
    """Return the model with the friction, the payload and the delay that nobody stated, where that is the likelier one.

    About a model without any friction nothing else is linear, and one finding after the other is a round each. What is
    not needed of it the search takes back.

    Args:
        linear: The campaign.
        screening: Everything that was tried.
        nominal: The nominal model; it is returned for a robot whose friction is stated.
        executor: Where to fit.
    """
    about = search_space(linear, screening.tried, screening.threshold, nominal)
    rise = about.model.additions(())
    best: dict[tuple[str, str], int] = {}
    for i in range(len(about.what)):
        cause = about.cause(i)
        if cause and cause.effect.name in LEFT_OUT and rise[i] >= rise[best.get(cause.key, i)]:
            best[cause.key] = i
    if not any(name == CoulombFriction.name for name, _ in best):
        return nominal
    fitter = Fitter(linear, nominal.fit, executor, settles=False)
    models = fitter.fitted([about.candidate_of(tuple(best.values()))])
    return max([nominal, *models], key=lambda model: model.log_posterior)
