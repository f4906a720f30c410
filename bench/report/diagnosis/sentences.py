"""What a verdict says in sentences, for the page and the terminal alike."""

import numpy as np

from bench.diagnose.verdict import ChannelGain, NamedCause, Proposal, Step, Unlisted, Verdict
from bench.report.diagnosis.names import (
    capital,
    cause_name,
    cause_names,
    channel_name,
    explanation_name,
    interval_of,
    letter,
    listed,
    parameter_text,
    percent,
    shown,
    unit_name,
)

ACTS = {
    "link torque": "a torque on the link of {place}",
    "motor torque": "a torque on the motor of {place}",
    "gear angle": "an error of the gear of {place}",
    "reading": "an error of the readings of {place}",
}
CLEARLY = 0.05  # gain of a channel by one step that is worth a word
WORST = 3  # noisy channels that are named
DECISIVE = 4.6  # log Bayes factor of odds of 100


def headline(verdict: Verdict) -> str:
    """Return the verdict in one sentence; of one that is unfinished, that first."""
    if not verdict.unfinished:
        return _headline(verdict)
    ended = f"Unfinished ({verdict.unfinished.why}, during: {verdict.unfinished.during})"
    if verdict.kind == "nothing weighed":
        return f"{ended}: nothing was weighed yet, so nothing is known of any cause."
    if verdict.kind == "nothing found so far":
        return f"{ended}: nothing was found so far."
    return f"{ended}. So far: {_headline(verdict)}"


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
    return words


def _headline(verdict: Verdict) -> str:
    if verdict.unlisted:
        words = f"An unlisted cause: {unlisted_name(verdict.unlisted)}, which no effect of the catalogue explains"
        beside = f"; beside it, {_named(verdict)}" if verdict.explanations else ""
        return f"{words}{beside}."
    if not verdict.explanations:
        if verdict.noisy:
            worst = channel_name(verdict.noisy[0].column)
            return f"Nothing found, but {worst} scatters {verdict.noisy[0].times:.3g} times as much as its instrument."
        return "Nothing found: the nominal model explains this campaign."
    return capital(f"{_named(verdict)}.")


def explanation_of_set(verdict: Verdict) -> str:
    """Return what it means that explanations stand side by side, "" where there is one."""
    count = len(verdict.explanations)
    if count < 2:
        return ""
    named = "; ".join(f"{letter(i)}, {explanation_name(e)}" for i, e in enumerate(verdict.explanations))
    return (
        f"These data cannot tell {count} explanations apart: {named}. Their probabilities are no reason to prefer one; "
        "each fits, with its own parameters. Do not correct the robot for one of them before another experiment has "
        "split them."
    )


def rate_sentence(verdict: Verdict) -> str:
    """Return how often chance alone would say that something was found."""
    return (
        f"Where the nominal model is right, chance would still find something in {percent(verdict.false_alarm_rate)} "
        "of such campaigns."
    )


def scatter_sentence(verdict: Verdict) -> str:
    """Return what the scale of the noise means, "" where it is as expected."""
    if verdict.noise_scale <= 1:
        return ""
    words = (
        f"The data scatter more than the instruments explain: their variance is {verdict.noise_scale:.3g} times as "
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


def unlisted_name(unlisted: Unlisted) -> str:
    """Return where an unlisted cause acts, and on what it depends."""
    acts = ACTS.get(unlisted.kind, unlisted.kind + " at {place}").format(place=unlisted.place)
    return f"{acts} that depends on {unlisted.depends_on}"


def gain_sentence(verdict: Verdict) -> str:
    """Return what the extension is worth on data that it has not seen, "" where nobody tried."""
    known = [gain for gain in verdict.gain if np.isfinite(gain.low) and np.isfinite(gain.high)]
    better = [gain for gain in known if gain.low > 0]
    worse = [gain for gain in known if gain.high < 0]
    if not known:
        return ""
    held_out = {"run": "runs", "block": "stretches of runs"}.get(verdict.held_out_by, "data")
    words = f"On {held_out} that were not fitted, {len(better)} of {len(known)} channels are predicted better"
    return f"{words}, {len(worse)} worse." if worse else f"{words}, none worse."


def gain_text(gain: ChannelGain) -> str:
    """Return the gain of one channel in a line."""
    before, after, floor = shown((gain.before, gain.after, gain.floor), gain.unit, gain.floor or gain.after)
    return (
        f"{channel_name(gain.channel)}: {before} -> {after} {unit_name(gain.unit)} (floor {floor}), "
        f"gain {percent(gain.gain)} ({percent(gain.low)} to {percent(gain.high)})"
    )


def step_text(step: Step) -> str:
    """Return what a step of the climb added and what that was worth, in a line."""
    added = " with ".join(cause_name(cause) for cause in step.added)
    held_out = f"held out {step.held_out:+.0f} ({step.low:.0f} to {step.high:.0f})"
    left = step_left(step)
    return f"{added}: {step.log_evidence:+.0f}, {held_out}" + (f"; {left}" if left else "")


def step_left(step: Step) -> str:
    """Return what a step leaves of the channels that it makes clearly better, "" where there is none."""
    texts = []
    for gain in step.channels:
        if gain.gain > CLEARLY and gain.low > 0:
            before, after = shown((gain.before, gain.after), gain.unit, gain.floor or gain.after)
            texts.append(f"{channel_name(gain.channel)} {before} -> {after} {unit_name(gain.unit)}")
    return ", ".join(texts)


def proposal_text(proposal: Proposal) -> str:
    """Return what an experiment would tell, in words."""
    first, second = proposal.splits
    if proposal.narrows:
        return f"It would narrow {proposal.narrows}."
    sure = "would decide" if proposal.separation > DECISIVE else "would help to decide"
    return (
        f"It {sure} between {first} and {second}: expected log Bayes factor {proposal.separation:.1f}, "
        f"{proposal.today:.1f} with the data at hand."
    )


def cause_text(cause: NamedCause) -> str:
    """Return a cause with its parameters in a line."""
    return f"{cause_name(cause)}: {', '.join(parameter_text(p) for p in cause.parameters)}"


def _named(verdict: Verdict) -> str:
    """Return the causes that all explanations share, and those that are open between them."""
    sets = [[cause_name(cause) for cause in e.causes] for e in verdict.explanations]
    common = [name for name in sets[0] if all(name in names for names in sets)]
    if len(sets) == 1:
        (only,) = verdict.explanations
        if len(only.causes) == 1:
            first = only.causes[0].parameters[0]
            value, low, high = interval_of(first)
            size = f"{first.name} {value} {unit_name(first.unit)}".rstrip()
            return f"{common[0]}: {size} (95 % interval {low} to {high})"
        return f"{len(common)} causes act together: {listed(cause_names(only.causes), 'and')}"
    rest = [" with ".join(name for name in names if name not in common) or "nothing else" for names in sets]
    either = "either " + listed(rest, "or") + ", which these data cannot tell apart"
    return f"{listed(common, 'and')}, and {either}" if common else either
