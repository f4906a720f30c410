"""What of a recording is worth freeing: what, fitted anew by itself, makes the recording far more probable.

Standard errors are those that count what the model leaves with the thing free (`fit_anew.py`), the same with it and
without. If nothing is anew, the expectation of such a ratio of probabilities is one, so it exceeds N with a probability
of 1/N at most (Markov's inequality); N is the number of things tried over the rate of false hints.

Several that pass may have one cause: gas that was lost looks like a payload, too. So the likeliest is free when the
next is tried, and so on; what then brings nothing more is left out, unless it does as well as one that stays. What does
not pass by itself is tried once more beside all that was found: friction of a colder day shows nothing where another
payload is most of what is left.

A model errs by itself, too: its diagnosis knew its figures and findings to so much, and another motion shows what those
that it was made of did not. These errors, as they vary together, are integrated out with a thing free and without
(`model_errors.py`): what they explain as well needs nothing that is anew.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.simulation_error import SIMULATED
from bench.errors import NOT_SIMULATED, InputError
from bench.predict.fit_anew import fit_anew, fitted_as
from bench.predict.free import FREE
from bench.predict.model_errors import ModelErrors

FALSE_HINTS = 0.01  # declared: of recordings in which nothing is anew
AS_GOOD = 3.0  # declared: difference of log evidence, twenty to one, within which none of two is preferred
# derived: the same as a part of it; two that act alike, each simulated wrong by a share e, differ by (2 e)^2 of what
# they explain (`name/simulation_error.py`)
AS_SIMULATED = 4 * SIMULATED**2


@dataclass(frozen=True, eq=False)
class WorthFreeing:
    """Something that may be anew in a recording.

    Attributes:
        name: In `FREE`.
        log_evidence: Logarithm of how many times more probable the recording is with it free.
        beside: What else is free in both, of what was found.
    """

    name: str
    log_evidence: float
    beside: tuple[str, ...] = ()


def worth_freeing(
    linear: LinearisedModel, free: Sequence[str], errors: ModelErrors | None = None
) -> tuple[WorthFreeing, ...]:
    """Return what else is worth freeing in a recording, with what each does by itself, the likeliest first.

    What passes only beside the others comes last, with what it does beside them.

    Args:
        linear: The recording, linearised about the model.
        free: What is free already.
        errors: Of the model; None: it is taken as exact.
    """

    def beside(free: Sequence[str], name: str) -> WorthFreeing | None:
        return _beside(linear, free, name, errors)

    tried = [one for name in FREE if name not in free and (one := beside(free, name))]
    least = np.log(len(tried) / FALSE_HINTS) if tried else 0.0
    passing = sorted((one for one in tried if one.log_evidence > least), key=lambda one: -one.log_evidence)
    found, passed = list[WorthFreeing](), list[str]()
    for one in passing:
        more = beside((*free, *passed), one.name) if passed else one
        if more and more.log_evidence > least:
            # by itself, or beside what was found, whichever says more
            found.append(max(one, replace(more, beside=tuple(passed)), key=lambda which: which.log_evidence))
            passed.append(one.name)
        elif any(_is_as_good(one, other) for other in found):
            found.append(one)
    known = list(passed)
    rest = [more for one in tried if known and one not in passing and (more := beside((*free, *known), one.name))]
    for first in sorted(rest, key=lambda one: -one.log_evidence):
        if first.log_evidence <= least:
            break
        more = first if passed == known else beside((*free, *passed), first.name)
        if more and more.log_evidence > least:
            found.append(replace(more, beside=tuple(passed)))
            passed.append(first.name)
    return tuple(found)


def _is_as_good(one: WorthFreeing, best: WorthFreeing) -> bool:
    return best.log_evidence - one.log_evidence < max(AS_GOOD, AS_SIMULATED * best.log_evidence)


def _beside(linear: LinearisedModel, free: Sequence[str], name: str, errors: ModelErrors | None) -> WorthFreeing | None:
    """Return what freeing something beside others brings; None where the recording shows nothing of it."""
    try:
        with_it = fit_anew(linear, (*free, name))
        without = fitted_as(linear, free, with_it[0].inflation)
    except (InputError, *NOT_SIMULATED):
        return None
    with_evidence, evidence = (
        fit.log_evidence + (errors.rise(own, fit) if errors else 0.0) for own, fit in (with_it, without)
    )
    return WorthFreeing(name, with_evidence - evidence)
