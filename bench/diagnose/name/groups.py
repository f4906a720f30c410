"""Ambiguity groups: what could stand in the place of each finding of a model, everything else as it is.

With five findings of which each has three names, there are 243 explanations; a reader wants five findings with three
names each. The names of a finding are those causes that, exchanged for it, give a model that the data cannot tell from
the best, with whatever names the other findings have, and that are likelier than nothing in its place.
"""

from collections.abc import Hashable, Mapping, Sequence, Set
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.special import logsumexp

from bench.diagnose.linearise.candidates import Cause

# declared: log posterior odds behind the best, up to where a model is not told apart from it (odds of 400)
IN_SET = 6.0
MOST_NEAR = 100  # effort: likeliest subsets in which a finding is exchanged
LEVEL = 0.99  # declared: of a set (DESIGN 6.2)

Keys = frozenset[Hashable]


@dataclass(frozen=True, eq=False)
class Member:
    """One of the names of a finding, with the probability that it acts, all other findings being what they are."""

    cause: Cause
    probability: float


@dataclass(frozen=True, eq=False)
class AmbiguityGroup:
    """A finding, and what cannot be told from it.

    Attributes:
        members: The likeliest first; the fewest that hold `LEVEL` of what all of them together do.
        probability: That any of them acts.
        may_be_unlisted: Whether a set at `LEVEL` holds that it is a part of what is unlisted (`beside_unlisted.py`).
    """

    members: tuple[Member, ...]
    probability: float
    may_be_unlisted: bool = False

    @property
    def keys(self) -> Keys:
        """Of its members."""
        return frozenset(member.cause.key for member in self.members)


def groups_of(
    best: Sequence[Hashable],
    posterior: Mapping[Keys, float],
    causes: Mapping[Hashable, Cause],
    simulated: Set[Keys] = frozenset(),
) -> tuple[AmbiguityGroup, ...]:
    """Return the ambiguity group of each listed cause of the best model, in their order.

    Args:
        best: Keys of the best model, the finding with the most evidence first.
        posterior: Subset of keys -> logarithm of its posterior odds, of all that were visited.
        causes: Key -> cause, of what is listed.
        simulated: Those subsets whose odds are of simulations; of others no more is known than what they are not above.
    """
    every = frozenset(best)
    near = [keys for keys, value in posterior.items() if value > posterior[every] - IN_SET and len(keys) <= len(every)]
    near = sorted(near, key=lambda keys: -posterior[keys])[:MOST_NEAR]
    exchanges: dict[Hashable, dict[Hashable, list[_Exchange]]] = {key: {} for key in best}
    for before, after in product([every, *(keys for keys in near if keys != every)], near):
        new, gone = after - before, before - after
        key = next((key for key in best if key in gone), None)  # of several, it stands for the one that explains most
        if len(new) != 1 or new & every or key is None:
            continue
        if posterior.get(after - new, -np.inf) >= posterior[after]:  # it adds nothing, and says that nothing is there
            continue
        if before == every or before.isdisjoint(exchanges[key]):  # with another of its names, nothing is missing
            found = _Exchange(before, after, {before, after} <= simulated)
            exchanges[key].setdefault(next(iter(new)), []).append(found)
    # of a model that was not finished, one cause may be all that is likely in the place of each of several findings
    by_names: dict[Keys, AmbiguityGroup] = {}
    for key in best:
        if key in causes:
            group = _group(key, exchanges[key], posterior, causes)
            by_names.setdefault(group.keys, group)
    return tuple(by_names.values())


@dataclass(frozen=True)
class _Exchange:
    """Two subsets of which one has a cause where the other has a finding, all else being the same.

    Attributes:
        before, after: With the finding, and with what stands for it.
        is_simulated: Whether both were.
    """

    before: Keys
    after: Keys
    is_simulated: bool


def _group(
    key: Hashable,
    exchanges: Mapping[Hashable, Sequence[_Exchange]],
    posterior: Mapping[Keys, float],
    causes: Mapping[Hashable, Cause],
) -> AmbiguityGroup:
    """Return the group of one finding.

    How its probability is shared among its names follows from subsets that are the same but for it, whatever its other
    findings are called there, and of these from those that were simulated, if there are any: a product of two sets of
    names need not have been visited. That any of them acts is a matter of all subsets.
    """
    odds = {key: 0.0}
    for one, every in exchanges.items():
        sure = [exchange for exchange in every if exchange.is_simulated] or every
        after, before = (logsumexp([posterior[getattr(e, end)] for e in sure]) for end in ("after", "before"))
        odds[one] = float(after - before)
    members = odds.keys()
    with_any = logsumexp([value for keys, value in posterior.items() if keys & members])
    any_of_them = float(np.exp(with_any - logsumexp(list(posterior.values()))))
    among_them = logsumexp(list(odds.values()))
    shares = {one: any_of_them * float(np.exp(value - among_them)) for one, value in odds.items() if one in causes}
    # the finding of the best model leads among equals, so that what is shown is what was fitted
    ranked = sorted(shares, key=lambda one: (-shares[one], one != key, str(one)))
    held = np.cumsum([shares[one] for one in ranked])
    count = 1 + int(np.searchsorted(held, LEVEL * held[-1]))
    return AmbiguityGroup(tuple(Member(causes[one], shares[one]) for one in ranked[:count]), any_of_them)
