"""What a fitted model will leave of a recording that nobody has made yet: an interval for each channel."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import stdtrit

from bench.diagnose.cross_validation.folds import Folds, folds_of, folds_of_states
from bench.diagnose.cross_validation.held_out import HIGH, SEED
from bench.diagnose.cross_validation.leave_out import errors_of_folds, tangent_of
from bench.diagnose.cross_validation.moderated import moderated
from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.alike import ALIKE, groups_of_passages
from bench.diagnose.replay.instants import at_each_instant, recordings_of
from bench.diagnose.replay.levels import mean_of_days
from bench.diagnose.replay.quantities import Quantity
from bench.effects.effect import Effect
from bench.record.campaign import Array
from bench.record.moving import TRAVELS

DRAWS = 4000  # effort: of recordings to come: ends of an interval are right to a few percent of its width
# declared: times; ends of an interval that are farther apart promise nothing. Of one channel in two blocks, the one
# missed three times as much as the other, they are 500 000 times apart: two numbers do not tell how far others scatter.
WIDEST = 1e3
# rounding: of a root mean square that is drawn, so that its square is a number: far beyond the quantiles
MOST_LOG = 300.0


def predicted_error(linear: LinearisedModel, fit: Fit) -> tuple[PredictedError, ...]:
    """Return what a fitted model will leave of an unseen recording of the same robot, for static runs and for motion.

    Each run of the campaign is predicted by the model as fitted to the others, without what is handed over to nobody:
    how much of its friction each joint held at rest. The logarithms of their root mean squares are taken as normal:
    one more run lies around their mean with s sqrt(1 + 1/K). How far runs differ, a few of them hardly say of one
    channel, so each channel's variance is held against those of all others (`moderated.py`).

    A campaign of one run is cut into blocks that stand for runs. Another motion passes other places: blocks that pass
    the same ones, there and back, are held out together, and each is predicted by the half of the run that is farthest
    from it. Of several recordings, each stands for a run, and what is its own (the zero of an encoder) is fitted to it.
    Where they repeat a program, that says nothing of another one: what they repeat is held out of all of them too, and
    the interval reaches as high as that says.

    How far two recordings differ in what is their own, no model can tell. So what drifts from one to the next
    (`effects/drifts.py`) comes on top of the squares: torque constants and viscous friction by the temperature of the
    day, zeros by the part of them that drifts. So does what is set up anew (a tracker, the zero of a link encoder),
    unless it will be fitted, and what was found to be wrong with the last recording itself, which the model has.

    Args:
        linear: The campaign.
        fit: The model.
    """
    promised = _promised(linear, fit, apart(linear, folds_of(linear)))
    states = folds_of_states(linear)
    if states is None:
        return promised
    elsewhere = {(one.channel, one.kind): one for one in _promised(linear, fit, states)}
    return tuple(_as_high(one, elsewhere[one.channel, one.kind]) for one in promised)


def _as_high(one: PredictedError, other: PredictedError) -> PredictedError:
    """Return an interval that reaches as high as another one of the same channel."""
    high, fitted_high = np.fmax([one.high, one.fitted_high], [other.high, other.fitted_high]).tolist()
    return replace(one, high=high, fitted_high=fitted_high)


def _promised(linear: LinearisedModel, fit: Fit, folds: Folds) -> tuple[PredictedError, ...]:
    """Return what is to be expected of one more fold."""
    of_campaign = np.array([not nuisance.is_simulated for nuisance in linear.nuisances], dtype=bool)
    error = errors_of_folds(linear, fit, tangent_of(linear, fit), folds, unknown=of_campaign)
    drifts = {**changes_of(linear, fit, "drifts"), **errors_found(linear, fit, _is_not_handed_over)}
    set_up = {**changes_of(linear, fit, "anew"), **errors_found(linear, fit, _is_set_up)}
    segments = linear.segments
    is_static = at_each_instant(segments, [segment.is_static for segment in segments])
    last = recordings_of(segments)[-1]
    is_last = at_each_instant(segments, [segment.recording == last for segment in segments])
    kinds: tuple[tuple[Literal["static", "motion"], Array], ...] = (("static", is_static), ("motion", ~is_static))
    known = []
    for c, quantity in enumerate(linear.quantities):
        if quantity.is_known:
            continue  # no recording to come has it
        for kind, chosen in kinds:
            seen = chosen & np.isfinite(error[:, c])
            count = folds.sums(seen.astype(np.float64))
            square = folds.sums(np.where(seen, error[:, c], 0.0) ** 2)
            there = count > 0
            if not np.any(there):
                continue
            rms = float(np.sqrt(square.sum() / count.sum()))
            left = np.sqrt(square[there] / count[there])
            shown = seen & is_last if np.any(seen & is_last) else seen
            drifting, anew = (
                np.array([np.sqrt(np.mean(change[shown, c] ** 2)) for change in changes.values()])
                for changes in (drifts, set_up)
            )
            known.append(_Seen(quantity, kind, rms, left, drifting, anew))
    spread = moderated([one.left for one in known])
    return tuple(one.promised(*student) for one, student in zip(known, spread, strict=True))


@dataclass(frozen=True, eq=False)
class _Seen:
    """A channel at rest or in motion, as far as it was seen.

    Attributes:
        quantity, kind: Which.
        rms: Of all held-out errors.
        left: Shape (K,), of those of each run.
        drifting, anew: Shape (d,) each, root mean squares of what drifts, or is set up anew, at one standard deviation.
    """

    quantity: Quantity
    kind: Literal["static", "motion"]
    rms: float
    left: Array
    drifting: Array
    anew: Array

    def promised(self, spread: float, degrees: float) -> PredictedError:
        """Return the promise, with the standard deviation of logarithms of one run, and its degrees of freedom."""
        ends = (
            *_one_more(self.left, np.concatenate([self.drifting, self.anew]), spread, degrees),
            *_one_more(self.left, self.drifting, spread, degrees),
        )
        return PredictedError(self.quantity.column, self.quantity.unit, self.kind, len(self.left), self.rms, *ends)


def changes_of(linear: LinearisedModel, fit: Fit, between: Literal["drifts", "anew"]) -> Mapping[str, Array]:
    """Return what each thing that drifts, or is set up anew, changes in the readings of the next, shape (T, c) each.

    They act in the last recording alone, where the model has them. An error is the sum of what lasts, with a variance
    L, and of what is the recording's own, with a variance D; nothing lasts of what is set up anew. The next recording
    has another own part: a mean of D + E[d^2] of the square of their difference. How large d was, the readings say only
    together with what lasts: where they know each sum of n recordings, the variance of d is L D / (D + n L), and so is
    that of the mean of all d, which the model has of what is of the day (`levels.py: handed_over`).

    Args:
        linear: The campaign.
        fit: The model.
        between: Which of the two.
    """
    linear, recordings = fit.design(linear), recordings_of(linear.segments)
    lasting = {one.name: one.sigma**2 for one in linear.nuisances if one.recording is None}
    off = {one: float(x) * one.sigma for one, x in zip(linear.nuisances, fit.nuisances, strict=True)}
    found = {}
    for i, one in enumerate(linear.nuisances):
        if one.between != between or one.recording not in (None, recordings[-1]):
            continue
        own, is_only = one.own**2, one.recording is None
        kept = one.lasting**2 if is_only else lasting.get(one.name, 0.0)
        # of the sum, or of the own part
        mean = fit.nuisances[i] * one.sigma * own / (kept + own) if is_only else mean_of_days(off, one)
        square = own + kept * own / (own + len(recordings) * kept) + mean**2
        found[one.name] = linear.sensitivities[:, :, i] * (np.sqrt(square) / one.sigma)
    return found


def errors_found(linear: LinearisedModel, fit: Fit, is_meant: Callable[[Effect], bool]) -> Mapping[str, Array]:
    """Return what each error of the last recording that was found changes in its readings, shape (T, c) each.

    A channel whose scale is wrong, a tracker that was set up askew, friction that fell while drives warmed up: the next
    recording has another such error, or none. A payload is none of them: a lab knows what it bolts on.

    Args:
        linear: The campaign.
        fit: The model.
        is_meant: Which effects count.
    """
    last = recordings_of(linear.segments)[-1]
    found: dict[str, Array] = {}
    for i, unknown in enumerate(fit.unknowns):
        cause = unknown.cause
        is_of_last = cause.place.recording in (None, last)
        if is_meant(cause.effect) and is_of_last and not unknown.parameter.is_shape:
            change = fit.jacobian[:, :, i] * fit.off[i]
            name = " ".join(cause.key)
            found[name] = found.get(name, 0.0) + change
    return found


def _is_not_handed_over(effect: Effect) -> bool:
    """Whether an effect is of a recording or of its time, and no slip of who wrote down what was bolted on."""
    return effect.level != "machine" and type(effect).log_error is Effect.log_error


def _is_set_up(effect: Effect) -> bool:
    return effect.level == "machine" and effect.family == "sensing" and effect.between == "anew"


def apart(linear: LinearisedModel, folds: Folds) -> Folds:
    """Return folds each of which is predicted from far away, if they are blocks of one run that goes anywhere.

    Others are returned as they are.

    Args:
        linear: The campaign.
        folds: Of it.
    """
    if folds.by != "block":
        return folds
    q = np.concatenate([segment.motion.q[segment.motion.read] for segment in linear.segments])
    spread = np.ptp(q, axis=0)
    moves = spread > TRAVELS
    if not np.any(moves):
        return folds
    places = q[:, moves] / spread[moves]
    group = groups_of_passages([places[folds.of_instants == f] / ALIKE for f in range(len(folds))])
    count = int(np.max(group)) + 1
    if count < 2:  # all of it is one place: then blocks of time are what there is
        return folds
    fold = group[folds.of_instants]
    gap = np.stack([np.any(folds.gap[:, group == g], axis=1) & (fold != g) for g in range(count)], axis=1)
    return Folds("block", fold, gap | _near(places, fold, count))


def _near(places: Array, fold: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    """Return which instants are not fitted since they are near to each fold, shape (T, K): half of all, with the fold.

    Args:
        places: Shape (T, n), of each instant, in spans of the joints.
        fold: Shape (T,), of each instant.
        count: Of folds.
    """
    near = np.zeros((len(fold), count), dtype=bool)
    trees = [cKDTree(places[fold == g]) for g in range(count)]
    for f in range(count):
        away = [float(np.median(tree.query(places[fold == f])[0])) for tree in trees]
        gone = np.count_nonzero(fold == f)
        for g in sorted(set(range(count)) - {f}, key=away.__getitem__):
            size = np.count_nonzero(fold == g)
            if gone + size / 2 > len(fold) / 2:  # by the nearest number of folds
                break
            gone += size
            near[fold == g, f] = True
    return near


def _one_more(rms: Array, drifting: Array, spread: float, degrees: float) -> tuple[float, float]:
    """Return the 90 % prediction interval of one more root mean square; nan where little says how far runs differ.

    It may be recorded at once, when nothing has drifted yet, or on another day. So the low end is that of the one, the
    high end that of the other, and the interval holds in both cases with 90 % at least.

    Args:
        rms: Shape (K,), log-normal.
        drifting: Shape (d,), root mean squares of what each drift changes at one standard deviation, independent.
        spread: Standard deviation of the logarithm of one of them.
        degrees: Degrees of freedom of that.
    """
    if not np.isfinite(spread) or not np.all(rms > 0):
        return np.nan, np.nan
    logs = np.log(rms)
    sigma = spread * np.sqrt(1 + 1 / len(rms))
    half = float(stdtrit(degrees, HIGH)) * sigma
    if 2 * half > np.log(WIDEST):
        return np.nan, np.nan
    low, high = float(np.exp(logs.mean() - half)), float(np.exp(logs.mean() + half))
    if not np.any(drifting):
        return low, high
    rng = np.random.default_rng(SEED)
    more = logs.mean() + sigma * rng.standard_t(degrees, DRAWS)
    square = np.exp(2 * np.minimum(more, MOST_LOG)) + rng.standard_normal((DRAWS, len(drifting))) ** 2 @ drifting**2
    return low, float(np.sqrt(np.quantile(square, HIGH)))
