"""What each constant of the diagnosis moves: it is halved and doubled, and the same campaigns are diagnosed again."""

from dataclasses import dataclass, field
from math import isclose

from scipy.linalg import LinAlgError
from threadpoolctl import threadpool_limits

from bench.effects.catalogue import catalogue
from bench.errors import BenchError
from bench.executor.contract import Executor, Progress, ignore, in_order
from bench.executor.serial import SERIAL
from bench.record.campaign import Campaign
from bench.study.blind import diagnose_with
from bench.study.constants import Constant, constants_of, set_to
from bench.study.labs import Lab
from bench.study.make import make
from bench.study.outcome import Answer, Name, Named, answer_of
from bench.study.plan import Counts, plan
from bench.study.study import Settings, setup_of

FACTORS = (0.5, 2.0)
FEW = Counts(seeds=1, nulls=1, unlisted=1, pairs=1, twins=False, effects=("gas_loss", "backlash"))


@dataclass(frozen=True)
class Variation:
    """A constant times a factor."""

    constant: Constant
    factor: float


@dataclass(frozen=True)
class Moved:
    """What a variation moves in one campaign.

    Attributes:
        campaign: Name of its trial.
        before, after: Causes of the likeliest explanation, and what is unlisted, in words.
        probability: Change of that which the likeliest explanation is given.
        shift: Largest change of a parameter that both name, in standard deviations of the first.
        width: Largest ratio of such a standard deviation to the first, or the inverse where it shrinks.
    """

    campaign: str
    before: str
    after: str
    probability: float
    shift: float
    width: float

    @property
    def is_other(self) -> bool:
        """Whether the verdict names something else."""
        return self.before != self.after


@dataclass(frozen=True)
class Variations:
    """Diagnoses campaigns with a constant changed; plain data, for any process with the same code.

    Attributes:
        settings: Of the study that makes the campaigns.
    """

    settings: Settings = field(default_factory=lambda: Settings(counts=FEW))

    def __call__(self, variation: Variation, _: Progress) -> tuple[Moved, ...]:
        """Return what a variation moves in each campaign."""
        campaigns, plain = _plain(self.settings)
        constant = variation.constant
        with set_to(constant, constant.times(variation.factor)), threadpool_limits(1, "blas"):
            answers = _answers(campaigns, self.settings)
        return tuple(moved(name, plain[name], answers[name]) for name in campaigns)


def vary(
    pattern: str, settings: Settings, executor: Executor = SERIAL, progress: Progress = ignore
) -> list[tuple[Variation, tuple[Moved, ...]]]:
    """Return what halving and doubling of each constant moves in a small study.

    Args:
        pattern: Which constants, as in `constants_of`.
        settings: Of the study; a handful of campaigns.
        executor: Serial or of processes: a constant is changed for all of a process.
        progress: Called with the share that is done.
    """
    known = constants_of(pattern)
    variations = [Variation(constant, factor) for constant in known for factor in FACTORS]
    changed = [one for one in variations if one.constant.times(one.factor) != one.constant.value]
    return list(zip(changed, in_order(executor, Variations(settings), changed, progress), strict=True))


def moved(campaign: str, before: Answer, after: Answer) -> Moved:
    """Return how two answers to the same campaign differ."""
    first, second = _likeliest(before), _likeliest(after)
    shift, width = 0.0, 1.0
    known = _values(second)
    for name, (value, sigma) in _values(first).items():
        if name in known and sigma > 0 and known[name][1] > 0:
            shift = max(shift, abs(known[name][0] - value) / sigma)
            ratio = known[name][1] / sigma
            width = max(width, ratio, 1 / ratio)
    said = [one.probability if one else 0.0 for one in (first, second)]
    return Moved(campaign, _words(before), _words(after), said[1] - said[0], shift, width)


def lines_of(variation: Variation, found: tuple[Moved, ...]) -> list[str]:
    """Return what a variation moves, in words: one line, and one more for each verdict that names something else."""
    constant, value = variation.constant, variation.constant.times(variation.factor)
    other = [one for one in found if one.is_other]
    same = [one for one in found if not one.is_other]
    probability = max((abs(one.probability) for one in found), default=0.0)
    shift, width = max((one.shift for one in same), default=0.0), max((one.width for one in same), default=1.0)
    if not other and isclose(width, 1.0, rel_tol=1e-9) and shift == 0.0 and probability == 0.0:
        return [f"{constant.words} {constant.value} -> {value}: nothing"]
    head = (
        f"{constant.words} {constant.value} -> {value}: other causes in {len(other)} of {len(found)}, probability by "
        f"{probability:.2g}, values by {shift:.2g} sigma, intervals by a factor of {width:.3g}"
    )
    return [head, *(f"    {one.campaign}: {one.before} -> {one.after}" for one in other)]


_made: dict[Settings, tuple[dict[str, Campaign], dict[str, Answer]]] = {}  # once in a process


def _plain(settings: Settings) -> tuple[dict[str, Campaign], dict[str, Answer]]:
    """Return the campaigns, and what is said of them with all constants as they stand."""
    if settings not in _made:
        setup = setup_of(settings)
        trials = plan(settings.counts, setup.compiled, settings.seed, setup.lab)
        campaigns = {trial.name: make(trial, setup, settings.seed).campaign for trial in trials}
        _made[settings] = campaigns, _answers(campaigns, settings)
    return _made[settings]


def _answers(campaigns: dict[str, Campaign], settings: Settings) -> dict[str, Answer]:
    """Diagnose campaigns of one session; the robot is compiled anew, for constants may change it."""
    known = catalogue()
    found = {}
    try:
        compiled = Lab(settings.session).compiled()
    except (BenchError, ArithmeticError, ValueError) as error:
        return dict.fromkeys(campaigns, _failed(error))
    for name, campaign in campaigns.items():
        try:
            found[name] = answer_of(diagnose_with(campaign, compiled, known).verdict)
        except (BenchError, LinAlgError, ArithmeticError, ValueError, IndexError) as error:
            found[name] = _failed(error)
    return found


def _failed(error: Exception) -> Answer:
    return Answer("failed", failure=f"{type(error).__name__}: {error}")


def _likeliest(answer: Answer) -> Named | None:
    return answer.explanations[0] if answer.explanations else None


def _values(named: Named | None) -> dict[tuple[Name, str], tuple[float, float]]:
    causes = named.causes if named else ()
    return {(cause.name, name): (one.value, one.sigma) for cause in causes for name, one in cause.values.items()}


def _words(answer: Answer) -> str:
    if answer.kind == "failed":
        return answer.failure
    first = _likeliest(answer)
    causes = sorted(f"{effect} ({place})" for effect, place in first.names) if first else []
    return ", ".join([*causes, *([f"unlisted at {answer.unlisted}"] if answer.unlisted else [])]) or answer.kind
