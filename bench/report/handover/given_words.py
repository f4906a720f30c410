"""What a diagnosis took over from an earlier one, in words."""

from collections.abc import Iterable

from bench.diagnose.replay.given import Posterior
from bench.diagnose.replay.nuisances import Nuisance


def given_sentence(posterior: Posterior, nuisances: Iterable[Nuisance]) -> str:
    """Return how much was given, and what was held as it was found.

    Args:
        posterior: Of the earlier diagnosis.
        nuisances: Of the later one.
    """
    told = {nuisance.name for nuisance in nuisances if nuisance.said_before}
    findings = [one.name for one in posterior.parameters if one.effect]
    held = [name.removesuffix(", as found before") for name in findings if name not in told]
    count = len(findings) - len(held)
    words = f"Given: what the earlier diagnosis knew of {len(told) - count} figures and {count} sizes of findings."
    return words + (f" Held as it was found there: {', '.join(held)}." if held else "")
