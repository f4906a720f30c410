"""Search over subsets of what may be wrong: best-first, with additions, deletions and exchanges.

Adding a cause after cause loses the smaller of two effects behind a dominant one; a joint search does not.
"""

import heapq
from collections.abc import Collection, Hashable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, combinations

import numpy as np
from scipy.special import logsumexp

from bench.diagnose.name.subset_posterior import SubsetPosterior
from bench.record.campaign import Array

WINDOW = 10.0  # effort: log posterior odds behind the best, beyond which a subset is not expanded (odds of 22 000)
MOST_EXPANDED = 40  # effort: subsets that are expanded
ADDITIONS = 12  # effort: best additions to each subset that are looked at
BEGINNINGS = 4  # effort: groups that a search begins with, beside the one from nothing
EXCHANGES = 5  # effort: best additions after each deletion
# effort: log posterior odds that the best exchange of a term lost, from where others of it are tried beside no more
# subsets: of twenty findings most have no other name
IRREPLACEABLE = 50.0


@dataclass(frozen=True)
class Subset:
    """Some terms together.

    Attributes:
        terms: Indices, in rising order.
        log_posterior: Logarithm of their posterior odds against the model without any finding.
    """

    terms: tuple[int, ...]
    log_posterior: float


def search(
    model: SubsetPosterior,
    start: Iterable[Sequence[int]] = ((),),
    always: tuple[int, ...] = (),
    expanded: int = MOST_EXPANDED,
    most: int | None = None,
) -> list[Subset]:
    """Return all subsets that were visited, the most probable first.

    Args:
        model: What may be added to what.
        start: Subsets to begin with.
        always: Terms that are in every subset.
        expanded: How many subsets are expanded.
        most: Terms of the largest subset that is visited; None: any.
    """
    visited: dict[tuple[int, ...], float] = {}
    queue: list[tuple[float, tuple[int, ...]]] = []
    rises: dict[tuple[int, ...], Array] = {}
    lost: dict[int, float] = {}  # by the best exchange of each term that was looked for so far

    def visit(which: Iterable[int]) -> None:
        terms = tuple(sorted(which))
        if terms not in visited and (most is None or len(terms) <= most):
            visited[terms] = model.log_posterior(terms)
            heapq.heappush(queue, (-visited[terms], terms))

    def best_additions(terms: tuple[int, ...], count: int) -> list[int]:
        if terms not in rises:
            rises[terms] = model.additions(terms, listed=True)
        rise = rises[terms]
        if not len(rise):
            return []
        order = np.argpartition(-rise, min(count, len(rise) - 1))[:count]
        return [int(i) for i in order if np.isfinite(rise[i])]

    for which in ((), *start):
        visit({*which, *always})
    for _ in range(expanded):
        if not queue or -queue[0][0] < max(visited.values()) - WINDOW:
            break
        terms = heapq.heappop(queue)[1]
        for i in best_additions(terms, ADDITIONS):
            visit((*terms, i))
        for gone in set(terms) - set(always):
            rest = tuple(i for i in terms if i != gone)
            visit(rest)
            if lost.get(gone, 0.0) > IRREPLACEABLE:
                continue
            instead = [i for i in best_additions(rest, EXCHANGES) if i != gone]
            for i in instead:
                visit((*rest, i))
            best = max((rises[rest][i] for i in instead), default=-np.inf)
            lost[gone] = min(lost.get(gone, np.inf), visited[terms] - visited[rest] - best)
    found = [Subset(terms, value) for terms, value in visited.items() if value > -np.inf]
    return sorted(found, key=lambda subset: -subset.log_posterior)


def searched_from_each(model: SubsetPosterior, starts: Iterable[Sequence[int]]) -> list[Subset]:
    """Return all subsets that searches of their own visited, one from each start, the most probable first."""
    found = {subset.terms: subset for start in starts for subset in search(model, [start])}
    return sorted(found.values(), key=lambda subset: -subset.log_posterior)


def everywhere(model: SubsetPosterior, groups: Sequence[Hashable | None]) -> list[tuple[int, ...]]:
    """Return subsets to begin with: all terms of a group together, each in its best shape; the likeliest groups first.

    What is otherwise in all drives at once, such as the friction of a warmer arm, is not reached term by term where
    each drive alone looks like something else. Beside another tool, friction 10 % less in all seven joints of a
    stranger's arm began as the mass of a link, and ended as all masses, rotors and torque constants 10 % higher: a
    local optimum, 240 nats behind, from which no exchange of two leads on.

    Args:
        model: Of which.
        groups: Of each term; None: it is in no group.
    """
    alone = model.additions(())
    found: dict[Hashable, dict[Hashable, int]] = {}
    for i, (term, name) in enumerate(zip(model.terms, groups, strict=True)):
        if name is not None and np.isfinite(alone[i]):
            group = found.setdefault(name, {})
            if alone[i] >= alone[group.get(term.key, i)]:
                group[term.key] = i
    odds = {terms: model.log_posterior(terms) for terms in (tuple(sorted(group.values())) for group in found.values())}
    several = [terms for terms, value in odds.items() if len(terms) > 1 and value > 0]
    return sorted(several, key=lambda terms: -odds[terms])[:BEGINNINGS]


def exchanges(model: SubsetPosterior, subset: Subset, always: tuple[int, ...] = (), most: int = 1) -> list[Subset]:
    """Return every subset in which another listed term stands in the place of one or more, up to `WINDOW` behind it.

    One cause may look like two: all drives that are late like the two whose torques show it most. A search does not
    get from there to the one, for with either of the two gone and the one in its place, the other is in the way.

    Args:
        model: What may be exchanged for what.
        subset: The best one.
        always: Terms that are not exchanged.
        most: In the place of how many; what stands in the place of several has to be worth something beside the rest.
    """
    found = []
    free = sorted(set(subset.terms) - set(always))
    for gone in chain.from_iterable(combinations(free, count) for count in range(1, most + 1)):
        rest = tuple(i for i in subset.terms if i not in gone)
        without, rise = model.log_posterior(rest), model.additions(rest, listed=True)
        least = subset.log_posterior - WINDOW
        for i in np.flatnonzero(without + rise > (least if len(gone) == 1 else max(least, without))):
            if i not in gone:
                terms = tuple(sorted((*rest, int(i))))
                found.append(Subset(terms, model.log_posterior(terms)))
    return [subset for subset in found if subset.log_posterior > -np.inf]


def likeliest_shapes(model: SubsetPosterior, keys: Collection[Hashable]) -> Subset | None:
    """Return a subset with some keys, of each the shape that is most probable beside the others; None: one is missing.

    Args:
        model: What may be in it.
        keys: Of the terms.
    """
    shapes = {key: [i for i, term in enumerate(model.terms) if term.key == key] for key in keys}
    if not all(shapes.values()):
        return None
    chosen = {key: some[0] for key, some in shapes.items()}
    for key, some in shapes.items():
        others = [i for other, i in chosen.items() if other != key]
        chosen[key] = max(some, key=lambda i: model.log_posterior(sorted((*others, i))))
    terms = tuple(sorted(chosen.values()))
    value = model.log_posterior(terms)
    return Subset(terms, value) if value > -np.inf else None


@dataclass(frozen=True)
class Alternative:
    """Subsets that say the same but for the shapes of their terms.

    Attributes:
        keys: Of the terms.
        best: The most probable of the subsets.
        log_posterior: Of all of them together.
    """

    keys: frozenset[Hashable]
    best: Subset
    log_posterior: float


def alternatives_of(model: SubsetPosterior, subsets: Iterable[Subset]) -> list[Alternative]:
    """Return what subsets say, whatever the shapes, the most probable first."""
    same: dict[frozenset[Hashable], list[Subset]] = {}
    for subset in subsets:
        same.setdefault(frozenset(model.terms[i].key for i in subset.terms), []).append(subset)
    found = [
        Alternative(keys, max(some, key=lambda s: s.log_posterior), float(logsumexp([s.log_posterior for s in some])))
        for keys, some in same.items()
    ]
    return sorted(found, key=lambda one: -one.log_posterior)
