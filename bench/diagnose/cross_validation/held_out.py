"""Measure: what an extension is worth on runs that it was not fitted to.

It pays if what was held out becomes more probable. Two kinds of things are held out, one at a time:

- every recording, predicted by the model fitted to the others; of a campaign that is one recording, every run; where
  recordings repeat a motion, what repeats is held out of all of them as well, and the lower worth of both counts;
- every stated figure of robot and instruments, predicted by all runs and the other figures. A nominal model with
  absurd figures predicts held-out runs as well as an extension does (a gas constant 12 sigmas off acts exactly as a
  loss of gas does), so runs alone would refuse causes that are true; the figure tells.

An effect that a single recording shows nearly alone cannot be checked with others; then its runs are held out. One
that a single run shows cannot be checked with other runs. That run is then cut into blocks of time, with a gap on both
sides of the block that is held out. `HeldOut.by` says which, for these are the weaker proofs.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.diagnose.cross_validation.floor import floor_variance
from bench.diagnose.cross_validation.folds import Folds, folds_of, folds_of_states
from bench.diagnose.cross_validation.leave_out import (
    Tangent,
    errors_of_folds,
    log_probability_of_figures,
    log_probability_of_folds,
    tangent_of,
)
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.other_noise import with_play
from bench.diagnose.replay.instants import recordings_of
from bench.record.campaign import Array

DRAWS = 2000  # effort: of the Bayesian bootstrap
SEED = 0  # exact: any: the same campaign gives the same interval
LOW, HIGH = 0.05, 0.95  # declared: quantiles of a 90 % interval
NOTICEABLE = 0.1  # rounding: [nats]; what changes nothing rises by rounding
# declared: [nats]; three times as probable. Below it is "not worth more than a bare mention" (Kass and Raftery 1995)
CONFIRMS = float(np.log(3.0))


@dataclass(frozen=True)
class ChannelGain:
    """How well runs that were not fitted are predicted, for one channel.

    Attributes:
        channel: Column of the campaign.
        unit: SI.
        before: Root mean square of what the model without the extension leaves of a run, fitted to the other runs as
            far as the stated uncertainty of its figures allows (`leave_out.REACH`).
        after: The same with the extension.
        floor: Expected of a right model (`floor_variance`); chance may leave less.
        gain: 1 - after / before.
        low, high: 90 % interval of the gain, over the runs.
        measured: Root mean square of what was measured (`Quantity.size`), with the same weights.
        nominal: What the nominal model leaves as it stands, nothing fitted.
        over_better: 1 - after / min(before, nominal): the gain over the better of the two, for a model whose figures
            were bent by the other runs may predict a run worse than the nominal one does.
        over_better_low, over_better_high: 90 % interval of it.
        readings: How many are compared.
    """

    channel: str
    unit: str
    before: float
    after: float
    floor: float
    gain: float
    low: float
    high: float
    measured: float
    nominal: float
    over_better: float
    over_better_low: float
    over_better_high: float
    readings: int

    @property
    def lost(self) -> float:
        """Log probability that its readings lose for sure [nats], at the upper end of the interval of the gain."""
        return max((1 - self.high) ** 2 - 1, 0.0) * self.readings * (self.before / self.floor) ** 2 / 2


@dataclass(frozen=True)
class RecordingGain:
    """What one recording says of an extension that was fitted to the others.

    Attributes:
        recording: Its name.
        nats: Rise of its log probability; nan where it could not be held against the others.
    """

    recording: str
    nats: float

    @property
    def confirms(self) -> bool:
        """Whether it becomes three times as probable: less is hardly worth a mention."""
        return self.nats > CONFIRMS


@dataclass(frozen=True)
class HeldOut:
    """What an extension is worth on what it was not fitted to.

    Attributes:
        nats: Rise of the log probability of all that was held out.
        low, high: 90 % interval of it, over the runs.
        figures: The part of `nats` that comes from the stated figures; the rest comes from the runs.
        by: What was held out at a time; `channels` and `recordings` are of that.
        decided_by: What was held out where `nats` is the least: the same, or "run" for what recordings repeat.
        folds: Number of them.
        channels: One entry for each column of the campaign that is compared.
        recordings: What each recording gains; nan where these were not what was held out, empty where there is one.
        of: Name of the recording that alone shows the extension, of whose readings `channels` are; "": of all.
    """

    nats: float
    low: float
    high: float
    figures: float
    by: Literal["recording", "run", "block"]
    decided_by: Literal["recording", "run", "block"]
    folds: int
    channels: tuple[ChannelGain, ...]
    recordings: tuple[RecordingGain, ...] = ()
    of: str = ""

    @property
    def is_gain(self) -> bool:
        """Whether what was held out becomes more probable, whichever runs one happened to make."""
        return self.low > NOTICEABLE

    def predicts_better(self, most_lost: float) -> bool:
        """Whether some channel that was poor gets better besides, and none surely worse.

        What was stated of the robot is no reason to believe what stands for something unlisted. Where others are seven
        times better, some channels lose 0.01 %.

        Args:
            most_lost: Log probability that the readings of a channel may lose for sure [nats].
        """
        is_better = any(one.low > 0 and one.before > one.floor for one in self.channels)
        return self.is_gain and is_better and not any(one.lost > most_lost for one in self.channels)


def held_out(
    linear: LinearisedModel,
    before: Fit,
    after: Fit,
    before_in: LinearisedModel | None = None,
    tangent: Tangent | None = None,
) -> HeldOut:
    """Return what `after` is worth against `before`.

    Intervals are a Bayesian bootstrap over the folds (Dirichlet weights), so an effect that two runs of twenty show is
    not refused for the eighteen that say nothing.

    Args:
        linear: The campaign.
        before: Fit of the model without the extension.
        after: Fit with it.
        before_in: The design of `before`, where that has fewer nuisances, the first of the other's; None: the same.
        tangent: Of `after`, where it is known.
    """
    designs = before_in or linear, linear
    count = len(before.nuisances)
    added = {cause.key: cause for cause in after.causes}.keys() - {cause.key for cause in before.causes}
    acts_in = {cause.place.recording for cause in after.causes if cause.key in added}
    only = acts_in.pop() if len(acts_in) == 1 else None
    changed = linear.whiten(before.residual - after.residual)
    folds = folds_of(linear, changed, only)
    tangents = tangent_of(designs[0], before), tangent or tangent_of(linear, after)
    one, two = (log_probability_of_folds(linear, tangent, folds) for tangent in tangents)
    figures = log_probability_of_figures(after, tangents[1], count) - log_probability_of_figures(before, tangents[0])
    rise = (two - one)[: folds.own]
    weights = _weights(len(rise))
    worth = _worth(rise, weights, figures, folds.by)
    if folds.by == "recording" and (states := folds_of_states(linear, changed)):
        before_it, after_it = (log_probability_of_folds(linear, tangent, states) for tangent in tangents)
        other = _worth(after_it - before_it, _weights(len(states)), figures, states.by)
        worth = min(worth, other, key=lambda one: one.low)
    both = zip(designs, (before, after), tangents, strict=True)
    first, second = (errors_of_folds(own, fit, tangent, folds) for own, fit, tangent in both)
    return HeldOut(
        nats=worth.nats,
        low=worth.low,
        high=worth.high,
        figures=figures,
        by=folds.by,
        decided_by=worth.by,
        folds=len(folds),
        channels=_channels(with_play(linear, after.play), folds, first, second, weights),
        recordings=_of_recordings(recordings_of(linear.segments), folds, two - one),
        of=folds.of,
    )


@dataclass(frozen=True)
class _Worth:
    """Rise of the log probability of what was held out, with its 90 % interval, and what that was."""

    nats: float
    low: float
    high: float
    by: Literal["recording", "run", "block"]


def _worth(rise: Array, weights: Array, figures: float, by: Literal["recording", "run", "block"]) -> _Worth:
    """Return what an extension is worth.

    Args:
        rise: Shape (K,), of the log probability of every fold.
        weights: Shape (draws, K), of the bootstrap.
        figures: Rise of that of the stated figures.
        by: What the folds are.
    """
    low, high = np.quantile(figures + len(rise) * weights @ rise, (LOW, HIGH))
    return _Worth(figures + float(np.sum(rise)), float(low), float(high), by)


def _weights(folds: int) -> Array:
    """Return the weights of a Bayesian bootstrap, shape (draws, folds)."""
    return np.random.default_rng(SEED).dirichlet(np.ones(folds), DRAWS)


def _of_recordings(names: tuple[str, ...], folds: Folds, rise: Array) -> tuple[RecordingGain, ...]:
    """Return what each recording gains, of the rise of every fold, shape (K,)."""
    if len(names) == 1:
        return ()
    nats = dict(zip(folds.recordings, rise.tolist(), strict=True)) if folds.recordings else {}
    return tuple(RecordingGain(name, nats.get(name, float("nan"))) for name in names)


def _channels(
    linear: LinearisedModel, folds: Folds, before: Array, after: Array, weights: Array
) -> tuple[ChannelGain, ...]:
    """Return the gain of every channel.

    Root mean squares are weighted with the floor's inverse variance. Static friction blurs currents at rest by up to
    twice the Coulomb level; plainly averaged, it would set the floor of the whole channel and hide in it any error of
    steady motion. With these weights `after / floor` is the root mean square of every reading's error in standard
    deviations of that reading: a perfect model gives 1, and a goal of 1.2 is a statement about all readings.

    Args:
        linear: The campaign.
        folds: What was held out at a time; K of them count.
        before: Shape (T, c), held-out errors without the extension.
        after: Shape (T, c), with it.
        weights: Shape (draws, K), of the bootstrap.
    """
    variance = floor_variance(linear)
    observed = linear.observed
    found = []
    for c, quantity in enumerate(linear.quantities):
        seen = np.isfinite(variance[:, c]) & folds.counts
        precision = np.where(seen, 1 / variance[:, c], 0.0)
        total = float(precision.sum())
        if total == 0:
            continue
        values = (before[:, c], after[:, c], linear.residual[:, c])
        one, two, zero = (folds.sums(precision * np.where(seen, value, 0.0) ** 2)[: folds.own] for value in values)
        drawn_one, drawn_two, drawn_zero = weights @ one, weights @ two, weights @ zero
        low, high = np.quantile(_gain(drawn_one, drawn_two), (LOW, HIGH))
        better_low, better_high = np.quantile(_gain(np.minimum(drawn_one, drawn_zero), drawn_two), (LOW, HIGH))
        sums = np.array([one.sum(), two.sum(), zero.sum()])
        left, better, nominal = np.sqrt(sums / total).tolist()
        gain, over_better = _gain(np.array([sums[0], min(sums[0], sums[2])]), sums[[1, 1]]).tolist()
        found.append(
            ChannelGain(
                channel=quantity.column,
                unit=quantity.unit,
                before=left,
                after=better,
                floor=float(np.sqrt(np.count_nonzero(seen) / total)),
                gain=gain,
                low=float(low),
                high=float(high),
                measured=quantity.size(observed[seen, c], precision[seen]),
                nominal=nominal,
                over_better=over_better,
                over_better_low=float(better_low),
                over_better_high=float(better_high),
                readings=int(np.count_nonzero(seen)),
            )
        )
    return tuple(found)


def _gain(before: Array, after: Array) -> Array:
    """Return the gains between sums of squares, same shape; 0 where nothing was to be gained."""
    share = np.divide(after, before, out=np.ones_like(after), where=before > 0)
    return 1 - np.asarray(np.sqrt(share), dtype=np.float64)
