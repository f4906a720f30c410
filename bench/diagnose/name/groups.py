"""Ambiguity groups: what could stand in the place of each finding of a model, everything else as it is.

With five findings of which each has three names, there are 243 explanations; a reader wants five findings with three
names each. The names of a finding are those causes that, exchanged for it, give a model that the data cannot tell from
the best.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from bench.diagnose.linearise.candidates import Cause

# declared: log posterior odds behind the best, up to where a model is not told apart from it (odds of 400)
IN_SET = 6.0
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
    best: Sequence[Hashable], posterior: Mapping[Keys, float], causes: Mapping[Hashable, Cause]
) -> tuple[AmbiguityGroup, ...]:
    """Return the ambiguity group of each listed cause of the best model, in their order.

    Args:
        best: Keys of the best model, the finding with the most evidence first.
        posterior: Subset of keys -> logarithm of its posterior odds, of all that were visited.
        causes: Key -> cause, of what is listed.
    """
    every = frozenset(best)
    members: dict[Hashable, set[Hashable]] = {key: {key} for key in best}
    for keys, value in posterior.items():
        new, gone = keys - every, [key for key in best if key not in keys]
        if len(new) == 1 and gone and value > posterior[every] - IN_SET:
            members[gone[0]] |= new  # of several that it does without, it stands for the one that explains most
    return tuple(_group(key, every, members[key], posterior, causes) for key in best if key in causes)


def _group(
    key: Hashable,
    best: Keys,
    members: set[Hashable],
    posterior: Mapping[Keys, float],
    causes: Mapping[Hashable, Cause],
) -> AmbiguityGroup:
    """Return the group of one finding.

    How its probability is shared among its names follows from the subsets that have no other new names: names of other
    findings are what they are, so a product of two sets of names need not have been visited. That any of them acts is
    a matter of all subsets.
    """
    alike = {keys: value for keys, value in posterior.items() if keys - best <= members and keys & members}
    among_them = float(logsumexp(list(alike.values())))
    alike = {keys: float(np.exp(value - among_them)) for keys, value in alike.items()}
    with_any = logsumexp([value for keys, value in posterior.items() if keys & members])
    any_of_them = float(np.exp(with_any - logsumexp(list(posterior.values()))))
    shares = {
        one: any_of_them * sum(share for keys, share in alike.items() if one in keys) for one in members & set(causes)
    }
    # the finding of the best model leads among equals, so that what is shown is what was fitted
    ranked = sorted(shares, key=lambda one: (-shares[one], one != key, str(one)))
    held = np.cumsum([shares[one] for one in ranked])
    count = 1 + int(np.searchsorted(held, LEVEL * held[-1]))
    return AmbiguityGroup(tuple(Member(causes[one], shares[one]) for one in ranked[:count]), any_of_them)
