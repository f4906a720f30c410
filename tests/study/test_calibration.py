"""Ranks of the truth, and the margin of evidence with which sets hold it."""

from math import inf

import numpy as np
import pytest

from bench.effects.gas import GasLoss
from bench.effects.sensing_drive import EncoderDelay
from bench.report.study.words import margin_words
from bench.study.calibration import Margin, Ranks, margin_of, ranks_of
from bench.study.goals import SURE, Goal, goals_of
from bench.study.outcome import Answer, Name, Named, Outcome, TrueCause
from bench.study.score import marks_of
from bench.study.shares import Share
from tests.study.answers import COULOMB, LOSS, WARM, explanation, outcome, single, truth

MANY = 400


def weighed(named: Named, evidence: float) -> Named:
    return Named(named.causes, named.probability, evidence)


def found(behind: float, is_rival: bool = False) -> Outcome:
    """Return an answer in which the truth has less evidence than something else."""
    best, true = weighed(explanation(WARM), 50.0), weighed(explanation(LOSS), 50.0 - behind)
    named, rivals = ((best,), (true,)) if is_rival else ((best, true), ())
    return outcome("single", truth(LOSS), Answer("cause", named, rivals=rivals))


def margin(outcomes: list[Outcome]) -> Margin | None:
    return margin_of([(one, marks_of(one)) for one in outcomes])


def goal(outcomes: list[Outcome], name: str) -> Goal:
    (only,) = (g for g in goals_of([(one, marks_of(one)) for one in outcomes]) if g.name.startswith(name))
    return only


@pytest.mark.parametrize(("error", "is_calibrated"), [(1.0, True), (0.5, False), (2.0, False)])
def test_ranks_are_even_where_what_is_stated_is_true(
    rng: np.random.Generator, error: float, is_calibrated: bool
) -> None:
    outcomes = [single(explanation(LOSS, value=0.1 + 0.01 * error * rng.standard_normal())) for _ in range(MANY)]
    every, of_effect = ranks_of([(one, marks_of(one)) for one in outcomes])
    assert every.counts == of_effect.counts
    assert (every.effect, of_effect.effect) == ("all", "gas_loss")
    assert sum(every.counts) == MANY
    assert (every.p > 0.001) is is_calibrated
    ends = (every.counts[0] + every.counts[-1]) / MANY
    assert ends < 0.1 if error < 1 else ends > 0.3 if error > 1 else 0.1 < ends < 0.3


def test_ranks_are_the_normal_distribution_below_the_truth() -> None:
    low, high = single(explanation(LOSS, value=0.1 - 0.02)), single(explanation(LOSS, value=0.1 + 0.02))
    (below, _), (above, _) = (ranks_of([(one, marks_of(one))]) for one in (low, high))
    assert below == Ranks("all", (*[0] * 9, 1), below.p)  # truth two sigma above what was found: rank 0.977
    assert above.counts == (1, *[0] * 9)


def test_margin_is_what_one_half_asks_for(rng: np.random.Generator) -> None:
    outcomes = [found(float(behind)) for behind in rng.uniform(0, 10, 2 * MANY)]
    learned = margin(outcomes)
    assert learned
    first = sorted(50.0 - one.answer.explanations[1].log_evidence for one in outcomes[::2])  # type: ignore[operator]
    assert learned.nats == pytest.approx(first[397 - 1])  # ceil(401 * 0.99) = 397
    assert learned.held.of == MANY
    assert learned.held.value > 0.97
    assert 1.9 < learned.size <= 2


def test_rivals_count_and_sets_as_given_do_not_have_them() -> None:
    learned = margin([found(3.0, is_rival=True)] * 10)
    assert learned
    assert learned.nats == pytest.approx(3.0)
    assert learned.held == Share(5, 5)
    assert learned.given == Share(0, 5)
    assert "3.0 nats" in margin_words(learned)


def test_truth_that_was_never_weighed_has_no_margin() -> None:
    wrong = outcome("single", truth(LOSS), Answer("cause", (weighed(explanation(WARM), 20.0),)))
    learned = margin([wrong] * 10)
    assert learned
    assert learned.nats == inf
    assert learned.held == Share(0, 5)
    assert "no margin holds" in margin_words(learned)
    assert margin([]) is None


def messy(answer: Answer, kind: str = "single") -> Outcome:
    """Return an answer about an arm with a loss of gas, or none, and a little Coulomb friction beside it."""
    true: tuple[TrueCause, ...] = truth(LOSS) if kind == "single" else ()
    return Outcome(
        "one",
        kind,
        "plausible",
        true,
        None,
        False,
        answer,
        1.0,
        1.0,
        "messy",
        truth(COULOMB),  # type: ignore[arg-type]
    )


def test_in_a_messy_arm_names_have_to_be_true_and_the_large_one_first() -> None:
    def is_first(*names: tuple[str, str]) -> bool:
        return marks_of(messy(Answer("several causes", (explanation(*names),)))).first

    assert is_first(LOSS)
    assert is_first(LOSS, COULOMB)
    assert not is_first(COULOMB, LOSS)
    assert not is_first(COULOMB)
    assert not is_first(LOSS, WARM)


def test_in_a_messy_null_only_what_is_not_there_is_a_false_alarm() -> None:
    right = messy(Answer("cause", (explanation(COULOMB),)), "null")
    wrong = messy(Answer("cause", (explanation(WARM),)), "null")
    called = messy(Answer("unlisted cause", (explanation(COULOMB),), unlisted="joint 2"), "null")
    assert goal([right] * 3, "false alarms").measured == Share(0, 3)
    assert goal([right, wrong, called], "false alarms").measured == Share(2, 3)


def test_intervals_count_wherever_a_true_cause_is_named() -> None:
    beside = single(explanation(LOSS, WARM))
    second = single(explanation(WARM), explanation(LOSS, value=0.2))
    assert marks_of(beside).covered == (("gas_loss.size", True),)
    assert marks_of(second).covered == (("gas_loss.size", False),)
    assert goal([beside, second], "90 % intervals").measured == Share(1, 2)
    assert marks_of(single(explanation(LOSS), explanation(LOSS, COULOMB))).covered == (("gas_loss.size", True),)


def test_sure_verdicts_are_counted_whatever_was_hidden() -> None:
    sure = single(explanation(LOSS, probability=SURE))
    unsure = single(explanation(WARM, probability=0.96))
    blamed = outcome("unlisted", truth(("detent", "joint 3")), Answer("cause", (explanation(LOSS, probability=1.0),)))
    assert goal([sure, unsure, blamed], "right, of verdicts").measured == Share(1, 2)


def test_errors_of_the_recording_have_goals_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    class Late(EncoderDelay):
        name = "channel_delay"
        level = "recording"

    monkeypatch.setattr("bench.study.goals.catalogue", lambda: {"channel_delay": Late(), "gas_loss": GasLoss()})
    late: Name = ("channel_delay", "tracker")
    named = single(explanation(late), true=truth(late))
    silent = single(explanation(LOSS, probability=0.99), true=truth(late))
    machine = single(explanation(LOSS))
    assert goal([named, silent, machine], "errors of the recording").measured == Share(1, 2)
    assert goal([named, silent, machine], "of them, taken").measured == Share(1, 2)
    assert goal([machine], "errors of the recording").met is None
