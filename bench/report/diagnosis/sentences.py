"""What a verdict says in sentences, for the page and the terminal alike."""

import re
from collections.abc import Iterator, Sequence

import numpy as np

from bench.diagnose.cross_validation.held_out import NOTICEABLE
from bench.diagnose.experiment_design.propose import NONE
from bench.diagnose.replay.quantities import LOADS
from bench.diagnose.verdict import ChannelGain, Proposal, Step, UndetectableEffect, Verdict
from bench.report.diagnosis.names import cause_name, cause_names, channel_name, effect_at, listed, unlisted_name
from bench.report.diagnosis.numbers import LEAST_WIDER, gain_percent, nats, percent, shown, unit_name

CLEARLY = 0.05  # gain of a channel by one step that is worth a word
ROUNDING = 1e-3  # of a gain; a channel that a model does not touch gains nothing but this
COLUMN = re.compile(r"[a-z]+(?:_[a-z0-9]+)+")
KNOWN = "known_"  # before the names of what the lab knows besides (`replay/quantities.py`)
WORST = 3  # noisy channels that are named
MOST_CHANNELS = 2  # of a step, in a line of the terminal
DECISIVE = 4.6  # log Bayes factor of odds of 100
WITHOUT_AND_WITH = "without it -> with it"
FLOOR = (
    "the error to be expected of a right model if instruments are as stated: by their noise and steps, the scatter of "
    "repeats, and an assumed spread of where friction and play come to rest; it is no bound: by chance, or with better "
    "instruments, less is left"
)


def unfinished_sentence(verdict: Verdict) -> str:
    """Return what an unfinished verdict means, "" where it is finished."""
    if not verdict.unfinished:
        return ""
    words = "This diagnosis ended before it was done: what is missing here was not looked for."
    promising = [cause_name(cause) for cause in verdict.unfinished.promising]
    if promising:
        words += f" Next it would have fitted {listed(promising, 'or')}: each may explain more, or nothing."
    if verdict.explanations:
        words += " What was found was not yet held against everything that could take its place."
    if any(not group.is_confirmed for group in verdict.findings):
        words += (
            " What is not confirmed was not held against other data either, which withdraw many findings: the "
            "probabilities here compare explanations as they stand."
        )
    return words


def open_names_sentence(verdict: Verdict) -> str:
    """Return what it means that a finding has several names, "" where none has."""
    count = sum(len(group.names) > 1 for group in verdict.findings)
    if not count and not verdict.other_explanations:
        return ""
    which = f"{count} of {len(verdict.findings)} findings have" if len(verdict.findings) > 1 else "the finding has"
    several = f"These data cannot tell the causes of a finding apart where several are named ({which} several). "
    if not count:
        several = "These data cannot tell the explanations apart. "
    return (
        f"{several}Their probabilities are no reason to prefer one; each fits, with its own parameters. Do not correct "
        "the robot for one of them before another experiment has split them."
    )


def rate_sentence(verdict: Verdict) -> str:
    """Return how often chance alone would say that something was found."""
    return (
        f"Where the nominal model is right, chance would still find something in {percent(verdict.false_alarm_rate)} "
        "of such campaigns."
    )


def scatter_sentence(verdict: Verdict) -> str:
    """Return what the scale of the noise means, "" where no interval shows it: chance alone makes it more than 1."""
    times = f"{verdict.noise_scale:.3g}"
    if not (np.sqrt(verdict.noise_scale) > LEAST_WIDER or verdict.noisy):  # nan where nothing was weighed
        return ""
    words = (
        f"The data scatter more than the instruments explain: their variance is {times} times as "
        "large, and all intervals are wider for it."
    )
    if not verdict.noisy:
        return words
    worst = ", ".join(
        f"{channel_name(one.column)} {'in motion' if one.in_motion else 'at rest'} by {one.times:.3g} times its "
        "instrument's error"
        for one in verdict.noisy[:WORST]
    )
    more = f", and {len(verdict.noisy) - WORST} more (noisy in verdict.json)" if len(verdict.noisy) > WORST else ""
    return f"{words} Worst: {worst}{more}. Nothing that was tried explains that, and a cause may hide in it."


def contradicted_sentences(verdict: Verdict) -> Iterator[str]:
    """Yield a sentence for each thing that the lab knows besides and all other readings contradict."""
    for one in verdict.contradicted:
        others = f"the model with what was found has {one.by_others:.4g}"
        if one.by_others_sigma:
            others = (
                "all other readings, by the nominal model with its figures free, make it "
                f"{one.by_others:.4g} ± {one.by_others_sigma:.2g}"
            )
        yield (
            f"{channel_name(one.channel).capitalize()} is stated as {one.value:.4g} ± {one.sigma:.2g} {one.unit}, but "
            f"{others}: {one.apart:.3g} standard errors apart. Look at what was written down under `known` before you "
            "believe a cause that is named: each had to explain both."
        )


def read_gains(verdict: Verdict) -> list[ChannelGain]:
    """Return the gains of channels that instruments read; what the lab knows besides is no prediction."""
    return [gain for gain in verdict.gain if not gain.channel.startswith(KNOWN)]


def gain_sentence(verdict: Verdict) -> str:
    """Return what the extension is worth on data that it has not seen, "" where nobody tried."""
    known = [gain for gain in read_gains(verdict) if np.isfinite(gain.over_better_low + gain.over_better_high)]
    better = [gain for gain in known if gain.over_better_low > ROUNDING]
    worse = [gain for gain in known if gain.over_better_high < -ROUNDING]
    if not known:
        return ""
    held_out = {"recording": "recordings", "run": "runs", "block": "stretches of runs"}.get(verdict.held_out_by, "data")
    of = f" of recording {verdict.held_out_of}" if verdict.held_out_of else ""
    words = (
        f"On {held_out}{of} that were not fitted, {len(better)} of {len(known)} channels "
        f"{'is' if len(better) == 1 else 'are'} predicted better than by "
        "the nominal model, as it stands or with its figures fitted"
    )
    return f"{words}, {len(worse)} worse." if worse else f"{words}, none worse."


def how_predicted(verdict: Verdict) -> str:
    """Return how what the model leaves in motion was predicted, and so what a promise rests on."""
    if verdict.held_out_by == "block":
        return "each block of the run predicted by others of it, by the farther half of them where they lie apart"
    return f"each {verdict.held_out_by or 'run'} predicted by the others"


def gain_text(gain: ChannelGain) -> str:
    """Return the gain of one channel in a line."""
    values = (gain.measured, gain.nominal, gain.before, gain.after, gain.floor)
    measured, nominal, fitted, after, floor = shown(values, gain.unit, gain.floor or gain.after)
    unit = f" {unit_name(gain.unit)}".rstrip()
    about = "" if gain.unit in LOADS else " about its mean"
    return (
        f"{channel_name(gain.channel)}: {nominal} -> {after}{unit} of {measured} measured{about} "
        f"(nominal fitted {fitted}, floor {floor}), gain {gain_percent(gain.over_better)} "
        f"({gain_percent(gain.over_better_low)} to {gain_percent(gain.over_better_high)})"
    )


def remainder_sentence(verdict: Verdict) -> str:
    """Return that something is left without a shape, or what is handed over where no model has it; "" for neither."""
    unlisted, sentences = verdict.unlisted, []
    if unlisted is None:
        return ""
    if not unlisted.stands_out:
        sentences.append(
            f"Something is left that is too small to give a shape: nearest to it comes {unlisted_name(unlisted)}, "
            "whose 95 % band holds zero everywhere."
        )
    elif not unlisted.runs and (verdict.findings or unlisted.stand_ins):
        sentences.append(f"The robot that is handed over lacks what is unlisted, {unlisted_name(unlisted)}.")
        if not unlisted.stand_ins:
            sentences.append(
                "It is fitted without that, so its figures (figures.csv) are not the sizes above, which are those "
                "beside it."
            )
    if unlisted.stand_ins:
        names = listed(cause_names(unlisted.stand_ins), "and")
        sentences.append(
            f"In its place the robot that is handed over has {names}: not all that acts there, but it surely predicts "
            "what was held out better than nothing. It is fitted with that, so its figures (figures.csv) are not the "
            "sizes above."
        )
    return " ".join(sentences)


def undetectable_sentence(verdict: Verdict, but: Sequence[UndetectableEffect] = ()) -> str:
    """Return the sizes that this campaign would not have shown as far as they are plausible, "" where there is none.

    Args:
        verdict: Of the campaign.
        but: What is said elsewhere.
    """
    said = {(spot.effect, place) for spot in but for place in spot.places}
    sizes: dict[tuple[str, str], list[str]] = {}
    for limit in verdict.detectable:
        if not limit.is_plausible and (limit.effect, limit.place) not in said:
            shapes = " of some shapes" if limit.limit <= limit.plausible else ""
            sizes.setdefault((limit.effect, limit.place), []).append(limit.parameter.replace("_", " ") + shapes)
    places: dict[tuple[str, str], list[str]] = {}
    for (effect, place), names in sizes.items():
        places.setdefault((effect, ", ".join(names)), []).append(place)
    named = [f"{effect_at(effect, some)}: {names}" for (effect, names), some in places.items()]
    return f"Not detectable at a plausible size: {'; '.join(named)}." if named else ""


def steps_sentence(verdict: Verdict) -> str:
    """Return what became of the steps that were taken where no cause of theirs is named, "" elsewhere."""
    if verdict.explanations or not any(step.accepted for step in verdict.steps):
        return ""
    return "No cause of these steps is kept: what is unlisted explains more than they do."


def step_text(step: Step) -> str:
    """Return what a step of the selection added and what that was worth, in a line."""
    added = " with ".join(cause_name(cause) for cause in step.added)
    evidence, worth = (nats(value, sign=True, tenths=False) for value in (step.log_evidence, step.held_out))
    low, high = (nats(value, tenths=False) for value in (step.low, step.high))
    more = (left_text(step, MOST_CHANNELS), unconfirmed_text(step), confirmed_text(step))
    return "; ".join(filter(None, (f"{added}: {evidence}, held out {worth} ({low} to {high})", *more)))


def left_text(step: Step, most: int) -> str:
    """Return `step_left` as a part of a line that says what both numbers are, "" where no channel becomes better."""
    left = step_left(step, most)
    return f"{WITHOUT_AND_WITH}{', ' if step.of_recording else ': '}{left}" if left else ""


def unconfirmed_text(step: Step) -> str:
    """Return why a finding that is kept is not confirmed, "" where it is."""
    if step.is_confirmed or not step.accepted:
        return ""
    share = percent(step.repeats)
    if step.recordings:
        return f"to be found it takes all recordings together (without one of them {share} of searches find it)"
    return f"not confirmed: only {share} of the searches without a part of the runs find it"


def confirmed_text(step: Step) -> str:
    """Return how many recordings confirm a finding of the machine, "" where that is no question."""
    if not step.recordings:
        return ""
    if all(np.isnan(one.nats) for one in step.recordings):
        return f"confirmed by 0 of {len(step.recordings)} recordings: one alone shows it"
    count = f"confirmed by {len(step.confirmed_by)} of {len(step.recordings)} recordings"
    return f"{count} ({', '.join(f'{one.recording} {one.nats:+.0f}' for one in step.recordings)})"


def refused_text(step: Step) -> str:
    """Return why a finding was given up, in a line: withdrawn, where other recordings do not repeat it."""
    names, reason = " with ".join(cause_name(cause) for cause in step.added), step.reason.rstrip(".")
    known = [one for one in step.recordings if np.isfinite(one.nats)]
    if known and step.low <= NOTICEABLE and len(step.confirmed_by) < len(known):
        return f"Withdrawn: {names}: it does not repeat from recording to recording, {confirmed_text(step)}."
    return f"Refused: {names}: {reason}."


def step_left(step: Step, most: int | None = None) -> str:
    """Return by how much channels are missed without a step and with it, "" where none becomes clearly better.

    All else is fitted both times. What one recording alone shows is told of its readings.

    Args:
        step: Of the selection.
        most: Channels that are told, those that gain most; the others are counted. None: all, in their order.
    """
    gains = [gain for gain in step.channels if gain.gain > CLEARLY and gain.low > 0]
    told = gains if most is None else sorted(gains, key=lambda gain: -gain.gain)[:most]
    texts = []
    for gain in told:
        before, after = shown((gain.before, gain.after), gain.unit, gain.floor or gain.after)
        texts.append(f"{channel_name(gain.channel)} {before} -> {after} {unit_name(gain.unit)}".rstrip())
    where = f"in recording {step.of_recording}: " if step.of_recording else ""
    more = f", {len(gains) - len(told)} more" if len(gains) > len(told) else ""
    return f"{where}{', '.join(texts)}{more}" if texts else ""


def proposal_text(proposal: Proposal) -> str:
    """Return what an experiment would tell, in words."""
    if proposal.narrows:
        return f"It would narrow {_with_channels(proposal.narrows)}."
    first, second = map(_with_channels, proposal.splits)
    question = f"between {first} and {second}"
    if NONE in proposal.splits:
        question = f"whether there is {second if proposal.splits[0] == NONE else first}"
    sure = "would decide" if proposal.separation > DECISIVE else "would help to decide"
    return (
        f"It {sure} {question}: it is expected to add {proposal.separation:.1f} to the logarithm of "
        f"their Bayes factor, which is {proposal.today:.1f} with the data at hand."
    )


def _with_channels(words: str) -> str:
    """Return words in which columns are called as people call them."""
    return COLUMN.sub(lambda found: channel_name(found[0]), words)
