"""What has the probability that the explanations that were simulated leave to all others."""

from bench.diagnose.verdict import UNLIKELY, Verdict
from bench.report.diagnosis.numbers import percent

REST = "the nominal model, and combinations of causes that were weighed but not simulated"
REST_OF_SEVERAL = (
    "other combinations of causes, the names of one finding with those of another, that were weighed but not simulated"
)


def rest_share(verdict: Verdict) -> float:
    """Return the probability that the explanations that were fitted leave to all others, 0 where next to none."""
    fitted = [*verdict.explanations, *verdict.rivals]
    left = 1 - sum(one.fitted_probability for one in fitted)
    return left if verdict.explanations and not verdict.unlisted and left >= UNLIKELY else 0.0


def rest_words(verdict: Verdict) -> str:
    """Return what has the probability that no simulated explanation has."""
    return REST if len(verdict.findings) == 1 else REST_OF_SEVERAL


def rest_sentence(verdict: Verdict) -> str:
    """Return to what the probability belongs that a single finding leaves, "" where there are several or hardly any."""
    left = rest_share(verdict)
    return f"The remaining {percent(left)}: {REST}." if left and len(verdict.findings) == 1 else ""
