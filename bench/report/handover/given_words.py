"""What a diagnosis took over from an earlier one, in words."""

from collections.abc import Iterable

from bench.diagnose.replay.given import Posterior, PosteriorParameter, is_anew
from bench.diagnose.replay.nuisances import Nuisance


def given_sentence(posterior: Posterior, nuisances: Iterable[Nuisance]) -> str:
    """Return how much was given, and what was held as it was found.

    Args:
        posterior: Of the earlier diagnosis.
        nuisances: Of the later one.
    """
    told = {nuisance.name for nuisance in nuisances if nuisance.said_before}
    findings = [one for one in posterior.parameters if one.effect]
    anew = [_short(one) for one in findings if is_anew(one)]
    held = [_short(one) for one in findings if one.name not in told and not is_anew(one)]
    count = len(findings) - len(held) - len(anew)
    words = f"Given: what the earlier diagnosis knew of {len(told) - count} figures and {count} sizes of findings."
    words += f" Held as it was found there: {', '.join(held)}." if held else ""
    return words + (f" Of that recording alone, so looked for anew: {', '.join(anew)}." if anew else "")


def _short(one: PosteriorParameter) -> str:
    return one.name.removesuffix(", as found before")
