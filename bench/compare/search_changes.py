"""Which changes explain the recordings: evidence for every cause with every course, and the posterior over subsets."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.compare.background import Background
from bench.compare.courses import Courses, courses_of
from bench.compare.profiles import Profile
from bench.diagnose.extend.fit import BEYOND
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.marginal import Marginal
from bench.diagnose.linearise.screening import NARROWER, Entry
from bench.diagnose.linearise.threshold import LEAST, family_threshold
from bench.diagnose.name.groups import IN_SET
from bench.diagnose.name.naming import shares_of
from bench.diagnose.name.search import Alternative, alternatives_of, everywhere, exchanges, searched_from_each
from bench.diagnose.name.search_space import GREATER_PART
from bench.diagnose.name.subset_posterior import SubsetPosterior, Term
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

MOST_TERMS = 1000  # effort: that a search is given, the best by evidence: memory stays small with many recordings
POWER_OF_LEVER = {"kg m": 1, "kg m^2": 2}  # exact
LEVERS = 3  # assumed: of a metre, a third of that, and a tenth, where tools sit; those that suit nothing share the odds
# rounding: norm of a column, whitened instant by instant, on a course on which it never acts
INVISIBLE = 1e-6


@dataclass(frozen=True, eq=False)
class Possible:
    """A cause or a free shape with its course.

    Attributes:
        entry: What.
        profile: How it runs over the recordings.
        prior: Shape (k,), standard deviations of its sizes, in steps.
        sign: Shape (k,), of the columns whose size can only be positive (1) or negative (-1); 0: either.
        log_odds: Its prior odds: those that chance passes at the declared rate.
    """

    entry: Entry
    profile: Profile
    prior: Array
    sign: Array
    log_odds: float

    @property
    def key(self) -> Hashable:
        """What it is, whatever its shape and its course."""
        return self.entry.cause.key if self.entry.cause else str(self.entry.what)


@dataclass(frozen=True, eq=False)
class Screened:
    """One course with all that may take it.

    Attributes:
        profile: The course.
        threshold: Log evidence that chance exceeds at its share of the declared rate.
        information: Shape (q,), on each column's size; 0 where it is not seen.
    """

    profile: Profile
    threshold: float
    information: Array


@dataclass(frozen=True, eq=False)
class Found:
    """What changed.

    Attributes:
        model: What the search was given.
        possible: What each of its terms is.
        alternatives: What subsets of listed causes say, the most probable first; that nothing changed is the first or
            the last of them.
        probability: Of each of them; one that has all causes of a likelier one and more counts for that, so with all
            of these one may be the most probable that by itself is not the likeliest.
        shape: Index of the free shape that explains more than the listed causes do; None: they suffice.
        screened: One for each course.
    """

    model: SubsetPosterior
    possible: tuple[Possible, ...]
    alternatives: tuple[Alternative, ...]
    probability: tuple[float, ...]
    shape: int | None
    screened: tuple[Screened, ...]

    @property
    def best(self) -> tuple[Possible, ...]:
        """What is named: the listed causes of the most probable alternative, or the free shape in their place."""
        terms = self.alternatives[0].best.terms if self.shape is None else (self.shape,)
        return tuple(self.possible[i] for i in terms)

    @property
    def probability_unchanged(self) -> float:
        """That nothing changed."""
        empty = (p for one, p in zip(self.alternatives, self.probability, strict=True) if not one.keys)
        return next(empty, 0.0)

    @property
    def near(self) -> tuple[int, ...]:
        """Indices of the alternatives that the data cannot tell from the best, without those that count for others."""
        best = self.alternatives[0].log_posterior
        found: list[int] = []
        for i, one in enumerate(self.alternatives):
            says_more = any(known and known < one.keys for known in (self.alternatives[j].keys for j in found))
            if one.log_posterior > best - IN_SET and (not says_more or self.probability[i] > 0):
                found.append(i)
        return tuple(found)


def find_changes(background: Background, profiles: Sequence[Profile], rate: float) -> Found:
    """Return what changed, everything else integrated out.

    Args:
        background: All recordings.
        profiles: Courses.
        rate: Share of unchanged machines of which anything at all may be said to have changed.
    """
    screened: list[Screened] = []
    possible: list[Possible] = []
    evidence: list[float] = []
    courses = courses_of(background)
    every = np.arange(background.columns.shape[1])
    signs = {id(entry): signs_of(entry, background.joint.linear.replay.compiled) for entry in background.entries}
    for profile in profiles:
        marginal = courses.marginal([(every, profile.weights)])
        seen = marginal.columns.squares > INVISIBLE**2
        alone = marginal.multiplied
        information = alone.diagonal
        entries = [entry for entry in background.entries if np.all(seen[entry.columns])]
        priors = {id(entry): priors_of(entry, information) for entry in entries}
        blocks = [(entry.columns, *prior) for entry in entries for prior in priors[id(entry)]]
        threshold = family_threshold(marginal, blocks, rate / len(profiles), np.random.default_rng(0))
        screened.append(Screened(profile, threshold, np.where(seen, information, 0.0)))
        mine = [
            Possible(entry, profile, prior, sign, share - claims * threshold - (0.0 if entry.cause else LEAST))
            for entry in entries
            for prior, share in priors[id(entry)]
            for sign, claims in signs[id(entry)]
        ]
        possible += mine
        evidence += _evidence(alone, mine).tolist()
    order = np.argsort(-np.array(evidence), kind="stable")
    chosen = tuple(possible[i] for i in order[:MOST_TERMS])
    model = _model(courses, chosen, len(every))
    places = [(one.entry.cause.effect.name, one.profile) if one.entry.cause else None for one in chosen]
    visited = searched_from_each(model, ((), *everywhere(model, places)))
    subsets = {subset.terms: subset for subset in (*visited, *exchanges(model, visited[0], most=2))}
    likeliest = alternatives_of(model, subsets.values())
    alternatives, probability = most_probable_first(likeliest)
    return Found(model, chosen, alternatives, probability, _shape(model, likeliest), tuple(screened))


def most_probable_first(likeliest: Sequence[Alternative]) -> tuple[tuple[Alternative, ...], tuple[float, ...]]:
    """Return alternatives in the order of their probabilities, and these.

    What has all causes of a likelier one and more counts for that one. Whether anything changed at all is told by what
    is the likeliest by itself: if that is nothing, it stays the first.

    Args:
        likeliest: In the order of what each says by itself.
    """
    shares = shares_of({one.keys: one.log_posterior for one in likeliest})
    order = list(likeliest)
    if order[0].keys:
        order.sort(key=lambda one: (not one.keys, -shares.get(one.keys, 0.0), -one.log_posterior))
    return tuple(order), tuple(shares.get(one.keys, 0.0) for one in order)


def sizes_of(found: Found, terms: tuple[int, ...]) -> tuple[Array, Array]:
    """Return the most probable sizes of the columns of some terms, and their standard deviations, in steps."""
    h, scores = found.model.equations(terms)
    covariance = np.linalg.inv(h)
    return np.asarray(covariance @ scores, dtype=np.float64), np.asarray(np.sqrt(np.diag(covariance)), dtype=np.float64)


def priors_of(entry: Entry, information: Array) -> tuple[tuple[Array, float], ...]:
    """Return standard deviations of a change, shape (k,) each, and the logarithm of the share of odds that each has.

    What is known of a change is how large it can be at most, not that it is about as large: a machine that is watched
    changes little. So all scales are as probable, from what is plausible down to what the recordings resolve. Where
    sizes are a mass with its moments, so are its levers (`levers_of`). A free shape has its own.

    Args:
        entry: A cause with its shape, or a free shape.
        information: Shape (q,), on the size of each column.
    """
    if entry.cause is None:
        return entry.priors
    plausible, share = entry.priors[0]
    resolved = float(np.max(plausible**2 * information[entry.columns]))
    count = 1 + max(int(0.5 * np.log(max(resolved, 1.0)) / -np.log(NARROWER)), 0)
    levers = levers_of(entry.cause)
    each = share + float(np.log(len(entry.priors) / (count * len(levers))))
    return tuple((plausible * lever * NARROWER**k, each) for k in range(count) for lever in levers)


def levers_of(cause: Cause) -> tuple[Array, ...]:
    """Return by how much each size of a cause shrinks, shape (k,), with the levers at which a mass may sit.

    A moment is a mass times a lever, a second moment times its square. What is plausible of them has a lever of a
    metre; a tool sits at a tenth of that. With one scale for all three, one that suits its moments holds its mass near
    nothing: of 0.35 kg more on a stranger's arm 0.21 to 0.29 kg came out, or a last link that is 43 % heavier.
    """
    powers = np.array([POWER_OF_LEVER.get(size.unit, 0) for size in cause.sizes])
    if "kg" not in (size.unit for size in cause.sizes) or not np.any(powers):
        return (np.ones(len(powers)),)
    return tuple(NARROWER ** (k * powers) for k in range(LEVERS))


def signs_of(entry: Entry, compiled: CompiledRobot) -> tuple[tuple[Array, int], ...]:
    """Return which signs a change may have, shape (k,) each (0: either), and how many things are claimed by each.

    A size that can have one sign only (friction per torque, a play) may fall by what the model has of it. Where that is
    nothing, less of it says two things: that there was some, which the model lacks, and that it is gone.

    Args:
        entry: A cause with its shape, or a free shape.
        compiled: The robot that changes are linear about.
    """
    grows = entry.sign
    if entry.cause and np.any(grows):
        there = entry.cause.effect.there_already(compiled, entry.cause.place)
        grows = np.where([there.get(size.name, 0.0) > 0 for size in entry.cause.sizes], 0.0, grows)
    return ((grows, 1), (-grows, 2)) if np.any(grows) else ((grows, 1),)


def _evidence(marginal: Marginal, possible: Sequence[Possible]) -> Array:
    """Return the log evidence of each with its odds, shape (number,); those with as many sizes are weighed together."""
    found = np.array([one.log_odds for one in possible])
    count = np.array([len(one.prior) for one in possible])
    for k in np.unique(count):
        which = np.flatnonzero(count == k).tolist()
        columns = np.stack([possible[i].entry.columns for i in which])
        prior, sign = (np.stack([getattr(possible[i], name) for i in which]) for name in ("prior", "sign"))
        found[which] += marginal.log_evidences(columns, prior, sign)
    return found


def _model(courses: Courses, possible: Sequence[Possible], count: int) -> SubsetPosterior:
    """Return the linearised model of what may have changed, each on its course, of `count` columns."""
    which: list[tuple[NDArray[np.intp], Array]] = []
    place: dict[int, NDArray[np.intp]] = {}
    start = 0
    for profile in {id(one.profile): one.profile for one in possible}.values():
        own = np.unique(np.concatenate([one.entry.columns for one in possible if one.profile is profile]))
        place[id(profile)] = np.full(count, -1)
        place[id(profile)][own] = start + np.arange(len(own))
        which.append((own, profile.weights))
        start += len(own)
    marginal = courses.marginal(which)
    terms = [_term(one, place[id(one.profile)][one.entry.columns]) for one in possible]
    return SubsetPosterior(marginal.information, marginal.scores, terms)


def _term(possible: Possible, columns: Array) -> Term:
    """Return a term of a search; a change goes no farther than is plausible."""
    listed = possible.entry.cause is not None
    most = BEYOND * np.sqrt(3) * possible.entry.priors[0][0] if listed else None  # a prior is high/sqrt(3) wide
    return Term(possible.key, columns, possible.prior, possible.log_odds, possible.sign, listed, most=most)


def _shape(model: SubsetPosterior, alternatives: Sequence[Alternative]) -> int | None:
    """Return the free shape that explains what changed so much better that no listed cause is believed; or None."""
    shapes = [i for i, term in enumerate(model.terms) if not term.is_listed]
    if not shapes:
        return None
    rise = model.additions((), listed=False)[shapes]
    best = int(np.argmax(rise))
    listed = alternatives[0].log_posterior
    if rise[best] > max(listed, 0.0) and listed < GREATER_PART * float(rise[best]):
        return shapes[best]
    return None
