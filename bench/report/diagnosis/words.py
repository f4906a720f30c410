"""A verdict in plain words."""

from collections.abc import Iterator

from bench.diagnose.verdict import Explanation, NamedCause, Verdict


def words_of(verdict: Verdict) -> Iterator[str]:
    """Yield the lines of a verdict for the terminal."""
    rate = f"{100 * verdict.false_alarm_rate:g} %"
    if verdict.kind == "nothing found":
        yield f"Nothing found (chance alone would raise an alarm in {rate} of such campaigns)."
    elif verdict.unlisted:
        u = verdict.unlisted
        yield f"Unlisted cause: {u.kind} at {u.place}, depending on {u.depends_on}; no listed effect explains it."
        if verdict.explanations:
            yield "Beside it, listed effects (what is unlisted may have bent them):"
    elif len(verdict.explanations) > 1:
        yield f"{len(verdict.explanations)} explanations that these data cannot tell apart:"
    elif verdict.explanations:
        yield "Found:"
    for explanation in verdict.explanations:
        yield from _explanation(explanation)
    if verdict.rivals and not verdict.unlisted:
        yield "Fitted, and less likely: " + "; ".join(_short(rival) for rival in verdict.rivals)
    if verdict.noise_scale > 1:
        yield (
            f"Scatter is {verdict.noise_scale**0.5:.1f} times what the instruments explain; intervals are wider for it."
        )
    for effect, channels in verdict.missing.items():
        yield f"Not looked for: {effect}, which needs {', '.join(channels)}."


def _explanation(explanation: Explanation) -> Iterator[str]:
    for i, cause in enumerate(explanation.causes):
        mark = f"{100 * explanation.probability:5.1f} %  " if i == 0 else "         "
        yield f"  {mark}{cause.title} ({cause.place}): {_sizes(cause)}"


def _sizes(cause: NamedCause) -> str:
    return ", ".join(f"{p.name} {p.value:.4g} [{p.low:.4g}, {p.high:.4g}] {p.unit}".rstrip() for p in cause.parameters)


def _short(explanation: Explanation) -> str:
    return " with ".join(f"{cause.effect} ({cause.place})" for cause in explanation.causes)
