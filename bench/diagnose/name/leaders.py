"""Which models a search is worth to simulate."""

from collections.abc import Callable, Hashable, Sequence, Set

from bench.diagnose.name.candidate_model import CandidateModel
from bench.diagnose.name.groups import IN_SET
from bench.diagnose.name.models import Fitter, Model, likeliest
from bench.diagnose.name.search import WINDOW, Alternative, Subset, alternatives_of, exchanges, likeliest_shapes, search
from bench.diagnose.name.search_space import SearchSpace
from bench.diagnose.name.subset_posterior import SubsetPosterior

NAMES = 2  # effort: other names of a finding that are simulated at last, until one cannot be told from it
EXCHANGED = 4  # effort: findings that get another name each time, those with the likeliest names
IN_ITS_PLACE = 0.5  # effort: of what a free shape explains, below which what is listed is not tried in its place
GROWING = 12  # effort: subsets that are expanded to find what is missing beside all of a model
MOST_PLAYS = 12  # effort: models with a play that are tried; one of 20 findings would be tried for minutes


def proposed(
    about: SearchSpace, found: Sequence[Alternative], count: int, *, adds: bool, is_last: bool
) -> list[tuple[int, ...]]:
    """Return the terms of the models that are worth a simulation beside the one that is known.

    Args:
        about: The known model, and what may be wrong beside it.
        found: By a search about it, the most probable first.
        count: How many of the best.
        adds: Whether models may have more findings than the known one.
        is_last: Whether what is listed in the place of a free shape is tried; it takes many findings, and hundreds of
            simulations each time.
    """
    leaders, best = leaders_of(found, count), found[0].best.terms
    terms = [one.best.terms for one in leaders]
    if adds:
        terms.append(grown(about, leaders))
    if about.shape:
        terms += without(about, best, about.shape, with_listed=is_last)
    terms.append(about.instead(best))
    return [some for some in terms if some and (adds or len(some) <= len(about.present))]


def leaders_of(found: Sequence[Alternative], count: int) -> list[Alternative]:
    """Return what is worth a simulation: the best, and the best of those that have all of a better one and more.

    Args:
        found: By a search, the most probable first.
        count: How many of the best.
    """
    near = [one for one in found if one.log_posterior > found[0].log_posterior - WINDOW]
    larger = [one for i, one in enumerate(near) if any(better.keys < one.keys for better in near[:i])]
    return [*[one for one in near if one not in larger][:count], *larger[:1]]


def with_other_names(
    about: SearchSpace, subsets: dict[tuple[int, ...], Subset], fitter: Fitter, models: Sequence[Model]
) -> list[Model]:
    """Return simulated models with those in which findings of the best have other names, as of `rivals_of`.

    Args:
        about: The model that the campaign is linearised about.
        subsets: That were visited, by their terms; `other_names` adds to them.
        fitter: That simulated the models.
        models: At least one.
    """
    every = list(models)
    for _ in range(NAMES):
        best = likeliest(every)
        if not best.keys or best.shape:
            break
        near = {model.keys for model in every if model.log_posterior > best.log_posterior - IN_SET}
        rivals = other_names(about, subsets, best.keys, near, fitter.models.keys())[:EXCHANGED]
        every += fitter.fitted([*map(about.candidate_of, rivals)])
    return every


def other_names(
    about: SearchSpace,
    subsets: dict[tuple[int, ...], Subset],
    best: frozenset[Hashable],
    near: Set[frozenset[Hashable]],
    known: Set[frozenset[Hashable]],
) -> list[tuple[int, ...]]:
    """Return the terms of models in which a finding of a simulated model has another name, as of `rivals_of`.

    Args:
        about: The model that the campaign is linearised about.
        subsets: That were visited, by their terms. The model and exchanges of each of its findings come to them.
        best: Keys of the model.
        near: Keys of the simulated models that cannot be told from it.
        known: Keys of all models that were simulated.
    """
    mine = next((one.best for one in alternatives_of(about.model, subsets.values()) if one.keys == best), None)
    mine = mine or likeliest_shapes(about.model, best)
    if mine is None:
        return []
    subsets |= {one.terms: one for one in (mine, *exchanges(about.model, mine, about.shape))}
    found = alternatives_of(about.model, subsets.values())
    return [one.best.terms for one in rivals_of(found, best, near, known)]


def rivals_of(
    found: Sequence[Alternative],
    best: frozenset[Hashable],
    near: Set[frozenset[Hashable]],
    known: Set[frozenset[Hashable]],
) -> list[Alternative]:
    """Return the likeliest other name of each finding of a simulated model for which no simulated one is as good.

    One finding with many names (from which run on gas was lost) leaves no room for those of another one among leaders,
    and where the best of simulated models is not the one that promised most, leaders have other names of that. What
    promises more together with another exchange, and falls short with it, says nothing of this name alone.

    Args:
        found: By a search and by exchanges of each finding of the model, the most probable first.
        best: Keys of the model.
        near: Keys of the simulated models that cannot be told from it.
        known: Keys of all models that were simulated.
    """
    named = {gone for keys in near if (gone := _exchanged(best, keys))}
    rivals: dict[frozenset[Hashable], Alternative] = {}
    for one in found:
        gone = _exchanged(best, one.keys)
        if gone and gone not in named and one.keys not in known:
            rivals.setdefault(gone, one)
    return list(rivals.values())


def _exchanged(best: frozenset[Hashable], other: frozenset[Hashable]) -> frozenset[Hashable]:
    """Return the finding of a model that another one has under another name, all others being the same; or nothing."""
    gone = best - other
    return gone if len(gone) == len(other - best) == 1 else frozenset()


def grown(about: SearchSpace, leaders: Sequence[Alternative]) -> tuple[int, ...]:
    """Return the most probable subset that has all of the model and more, where no leader has; else nothing.

    What promises more without a part of the model may fall short of it when simulated; what has all of it does not.
    """
    if not about.present or any(one.keys > about.about.keys for one in leaders):
        return ()
    best = search(about.model, [about.present], about.present, GROWING)[0].terms
    return best if len(best) > len(about.present) else ()


def without(
    about: SearchSpace, terms: Sequence[int], shape: tuple[int, ...], *, with_listed: bool
) -> tuple[tuple[int, ...], ...]:
    """Return the terms of a model without its shape, as they are and with what is listed in the place of that.

    What is listed and promises little of what the shape explains is left out: no fit makes that up.
    """
    alone = tuple(i for i in terms if i not in shape)
    if not with_listed:
        return (alone,)
    best = search(about.model, [alone], expanded=GROWING)[0]
    return tuple(dict.fromkeys((alone, best.terms))) if stands_in_for(about.model, best, alone, terms) else (alone,)


def stands_in_for(model: SubsetPosterior, best: Subset, alone: Sequence[int], terms: Sequence[int]) -> bool:
    """Whether listed terms explain the greater part of what a free shape does beside others, which are `alone`."""
    nothing, everything = (float(model.log_posterior(some)) for some in (alone, terms))
    return best.log_posterior - nothing >= IN_ITS_PLACE * (everything - nothing)


def scattering(
    about: SearchSpace,
    leader: Alternative,
    behind: Set[frozenset[Hashable]],
    is_needed: Callable[[Sequence[int], int, int], bool],
) -> dict[frozenset[Hashable], CandidateModel]:
    """Return the leader with a play beside or in the place of anything at its joint, by what acts at that joint then.

    Where a link rests within its play is chance, so its signature alone shows little of it.

    Args:
        about: What may be wrong.
        leader: The best subset of it.
        behind: What acted at one joint with a play in models that fell behind. Findings elsewhere do not change that.
        is_needed: Returns whether a play falls short in the place of a term, of all terms, that one, and the play.
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
            fewer = () if is_needed(terms, i, play) else (tuple(one for one in terms if one != i),)
            for kept in (*fewer, terms):
                there = frozenset(about.model.terms[i].key for i in (*kept, play) if about.what[i].drive == what.drive)
                if there not in behind and len(found) < MOST_PLAYS:
                    found[there] = about.candidate_of((*kept, play))
    return found
