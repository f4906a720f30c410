"""Recordings by one program repeat what the model gets wrong: what they repeat is held out of all of them."""

from dataclasses import replace

import numpy as np

from bench.diagnose.diagnose import diagnose
from bench.diagnose.replay.alike import groups_of_passages
from bench.effects.catalogue import catalogue
from bench.record.campaign import Campaign
from bench.record.joined import joined
from bench.report.diagnosis.sentences import refused_text
from tests.diagnose.sweeps import SWEEPS, made, nominal


def with_waves(campaign: Campaign) -> Campaign:
    """Return a campaign of whose first run the current swings over the angle, as of a drive that rings in it."""
    first, *others = campaign.runs
    current = first.columns["current_2_a"] + np.sin(12 * first.columns["q_motor_2_rad"])
    return replace(campaign, runs=(replace(first, columns={**first.columns, "current_2_a": current}), *others))


def test_what_one_run_of_a_program_shows_each_time_is_not_the_machines() -> None:
    """A drive that rings after each ramp was a transmission error at > 99.9 %, confirmed by 2 of 2 recordings."""
    both = joined({name: with_waves(made(SWEEPS, seed)) for name, seed in (("A", 1), ("B", 2))})
    choice = {name: catalogue()[name] for name in ("friction_ripple", "transmission_error", "coulomb_level")}
    verdict = diagnose(both, nominal(), choice, most_bins=100, proposes=False).verdict
    assert verdict.kind == "nothing found"
    (step,) = verdict.steps
    assert step.confirmed_by == ("A", "B"), "what repeats is confirmed by both"
    assert not step.accepted
    assert refused_text(step).startswith("Refused: friction depends on the angle (joint 2): ")
    assert step.reason == "held-out runs do not become more probable"


def test_passages_that_meet_are_together_and_others_are_not() -> None:
    way = np.linspace(0, 20, 30)[:, None]
    aside = np.column_stack([way, np.full(30, 5.0)])
    there = np.column_stack([way, np.zeros(30)])
    short = there[:4] + np.array([0.0, 4.5])  # meets a few states of `aside`, which is no more than a part of that
    assert groups_of_passages([there, there[::-1] + 0.3, aside]).tolist() == [0, 0, 1]
    assert groups_of_passages([there, aside, short]).tolist() == [0, 1, 1], "the greater part of the short one"
