"""Which models a search is worth to simulate."""

from collections.abc import Hashable, Sequence, Set

from bench.diagnose.name.models import CandidateModel
from bench.diagnose.name.search import WINDOW, Alternative, search
from bench.diagnose.name.search_space import SearchSpace

GROWING = 12  # effort: subsets that are expanded to find what is missing beside all of a model
MOST_PLAYS = 12  # effort: models with a play that are tried; one of 20 findings would be tried for minutes


def leaders_of(found: Sequence[Alternative], count: int, exchanged: int = 0) -> list[Alternative]:
    """Return what is worth a simulation: the best, and the best of those that have all of a better one and more.

    Args:
        found: By a search, the most probable first.
        count: How many of the best.
        exchanged: For so many findings of the best of all that have the same name in these, the likeliest other name.
            One finding with many names (from which run on gas was lost) else leaves no room for those of another one.
    """
    near = [one for one in found if one.log_posterior > found[0].log_posterior - WINDOW]
    larger = [one for i, one in enumerate(near) if any(better.keys < one.keys for better in near[:i])]
    leaders = [one for one in near if one not in larger][:count]
    best = found[0].keys
    others: list[Alternative] = []
    for one in near:
        gone = best - one.keys
        if len(gone) == len(one.keys - best) == 1 and all(gone <= other.keys for other in (*leaders, *others)):
            others.append(one)
    return [*leaders, *others[:exchanged], *larger[:1]]


def grown(about: SearchSpace, leaders: Sequence[Alternative]) -> tuple[int, ...]:
    """Return the most probable subset that has all of the model and more, where no leader has; else nothing.

    What promises more without a part of the model may fall short of it when simulated; what has all of it does not.
    """
    if not about.present or any(one.keys > about.about.keys for one in leaders):
        return ()
    best = search(about.model, [about.present], about.present, GROWING)[0].terms
    return best if len(best) > len(about.present) else ()


def without(about: SearchSpace, terms: Sequence[int], shape: tuple[int, ...]) -> tuple[tuple[int, ...], ...]:
    """Return the terms of a model without its shape, as they are and with what is listed in the place of that."""
    alone = tuple(i for i in terms if i not in shape)
    listed = search(about.model, [alone], expanded=GROWING)[0].terms
    return tuple(dict.fromkeys((alone, listed)))


def scattering(
    about: SearchSpace, leader: Alternative, behind: Set[frozenset[Hashable]]
) -> dict[frozenset[Hashable], CandidateModel]:
    """Return the leader with a play beside or in the place of anything at its joint, by what acts at that joint then.

    Where a link rests within its play is chance, so its signature alone shows little of it.

    Args:
        about: What may be wrong.
        leader: The best subset of it.
        behind: What acted at one joint with a play in models that fell behind. Findings elsewhere do not change that.
    """
    terms = leader.best.terms
    found: dict[frozenset[Hashable], CandidateModel] = {}
    for play, what in enumerate(about.what):
        cause = about.cause(play)
        if cause is None or not cause.effect.scatters or cause.key in leader.keys:
            continue
        for i in terms:
            other = about.cause(i)
            if about.what[i].drive != what.drive or (other and other.effect.scatters):
                continue
            for kept in (tuple(one for one in terms if one != i), terms):
                there = frozenset(about.model.terms[i].key for i in (*kept, play) if about.what[i].drive == what.drive)
                if there not in behind and len(found) < MOST_PLAYS:
                    found[there] = about.candidate_of((*kept, play))
    return found
