"""Outcomes made by hand: a truth, and an answer to it."""

from bench.study.outcome import Answer, Found, FoundCause, FoundGroup, Name, Named, Outcome, TrueCause
from bench.study.plan import Kind

LOSS: Name = ("gas_loss", "robot")
WARM: Name = ("gas_temperature", "robot")
COULOMB: Name = ("coulomb_level", "joint 2")


def truth(*names: Name, value: float = 0.1, times_limit: float = 3.0) -> tuple[TrueCause, ...]:
    return tuple(TrueCause(*name, {"size": value}, 0.3, 0.3 / times_limit) for name in names)


def explanation(*names: Name, probability: float = 0.9, value: float = 0.1, sigma: float = 0.01) -> Named:
    return Named(tuple(FoundCause(*name, {"size": Found(value, sigma)}) for name in names), probability)


def outcome(
    kind: Kind,
    true: tuple[TrueCause, ...],
    answer: Answer,
    twin: Name | None = None,
    is_split: bool = False,
    name: str = "one",
) -> Outcome:
    return Outcome(name, kind, "three limits", true, twin, is_split, answer, 2.0, 4.0)


def single(*explanations: Named, true: tuple[TrueCause, ...] | None = None) -> Outcome:
    if not explanations:
        return outcome("single", true or truth(LOSS), Answer("nothing found"))
    first, *others = explanations
    own = [((cause.name, first.probability),) for cause in first.causes]
    own[0] += tuple((one.causes[0].name, one.probability) for one in others)
    answer = Answer("cause", explanations, held_out=1.1, findings=tuple(FoundGroup(names, 1.0) for names in own))
    return outcome("single", true or truth(LOSS), answer)
