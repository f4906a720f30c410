"""Where a search begins: what drawings leave out of a robot is found at once, for all of it is missing at once."""

from collections.abc import Collection, Hashable
from dataclasses import replace
from functools import partial

import numpy as np

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import Tried
from bench.diagnose.name.candidate_model import CandidateModel
from bench.diagnose.name.models import Fitter, Model, likeliest
from bench.diagnose.name.search_space import search_space
from bench.effects.balancer import SpringBalancer
from bench.effects.catalogue import LEFT_OUT
from bench.effects.friction import CoulombFriction
from bench.effects.friction_shape import LoadFriction
from bench.effects.geometry import DressPack
from bench.effects.lubricant import RollingFriction
from bench.executor.contract import Executor
from bench.identify.dynamics.equations import BALANCER, DRIVE_COLUMNS
from bench.identify.dynamics.found import FirstPass

# what a first pass has of a drive -> name of the effect
TOLD = {
    "rolling": RollingFriction.name,
    "load": LoadFriction.name,
    "spring": DressPack.name,
    "balancer": SpringBalancer.name,
}


def told_by(first: FirstPass | None) -> dict[tuple[str, int], float]:
    """Return what a first pass has beside what drawings leave out: effect and index of its drive -> first size.

    Of a balancer that is the amplitude of its first harmonic, for each of its sizes may have either sign.
    """
    if first is None:
        return {}
    own = {name: first.parameters[first.layout.of_drives(name)] for name in DRIVE_COLUMNS}
    sizes = own | {"balancer": np.hypot(*(own[name] for name in BALANCER[:2]))}
    return {(TOLD[name], j): float(sizes[name][j]) for name in TOLD for j in first.has[name]}


def with_what_drawings_leave_out(
    linear: LinearisedModel,
    tried: Tried,
    threshold: float,
    nominal: Model,
    executor: Executor,
    told: Collection[tuple[str, int]] = (),
) -> Model:
    """Return the model with all that nobody stated (`LEFT_OUT`), where that is the likelier one.

    About a model without any friction nothing else is linear, and one finding after the other is a round each. What is
    not needed of it the search takes back. Where a fit begins decides which optimum it ends in, for a first moment
    without a mass shows nothing: it is begun from what signatures say and from causes of no size.

    What a first pass has beside is taken with it where it explains more. Of what is left about a model without any
    friction most is not noise, so nothing small seems worth its odds yet; the first pass has paid them, on what was
    held out. A cable at a wrist that is looked for later is looked for beside whatever took its place meanwhile.

    Args:
        linear: The campaign.
        tried: Everything that can be tried.
        threshold: Log evidence that chance exceeds at the declared rate.
        nominal: The nominal model; it is returned for a robot whose friction is stated.
        executor: Where to fit.
        told: What a first pass has: names of effects, each with the index of its drive.
    """
    candidate = what_is_left_out(linear, tried, threshold, nominal)
    if not any(cause.effect.name == CoulombFriction.name for cause in candidate.causes):
        return nominal
    begun = partial(_begun, linear, nominal, executor)
    best = likeliest([nominal, *begun(candidate)])
    beside = begun(what_is_left_out(linear, tried, threshold, nominal, told=told)) if told else []
    return max([best, *beside], key=lambda model: model.fit.log_evidence)


def _begun(linear: LinearisedModel, nominal: Model, executor: Executor, candidate: CandidateModel) -> list[Model]:
    """Return a candidate fitted from what signatures say, and from causes of no size."""
    fitter = Fitter(linear, nominal.fit, executor, settles=False)
    return [model for start in (candidate.start, {}) for model in fitter.fitted([replace(candidate, start=start)])]


def what_is_left_out(
    linear: LinearisedModel,
    tried: Tried,
    threshold: float,
    nominal: Model,
    told: Collection[tuple[str, int]] = (),
) -> CandidateModel:
    """Return all of it, to be fitted from what signatures say; of a cause with shapes, in the one that explains most.

    Args:
        linear: The campaign.
        tried: Everything that can be tried.
        threshold: Log evidence that chance exceeds at the declared rate.
        nominal: The nominal model.
        told: Names of further effects, each with the index of a drive.
    """
    about = search_space(linear, tried, threshold, nominal)
    rise = about.model.additions(())
    best: dict[Hashable, int] = {}
    for i in range(len(about.what)):
        cause = about.cause(i)
        if cause is None or not (cause.effect.name in LEFT_OUT or (cause.effect.name, cause.drive) in told):
            continue
        if rise[i] >= rise[best.get(cause.key, i)]:
            best[cause.key] = i
    return about.candidate_of(tuple(best.values()))
