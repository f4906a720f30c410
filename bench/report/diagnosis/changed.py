"""What has changed since the diagnosis from which this one started, in words: figures by what they are, then by joint.

Whether that is much for a machine from one day to another is said beside it, and is no condition: friction that fell by
an eighth is worth a word although it drifts as far.
"""

from collections.abc import Iterator

from bench.diagnose.verdict import FittedFigure, Verdict
from bench.report.diagnosis.names import BEFORE, fitting, title_of
from bench.report.diagnosis.numbers import shown, unit_name

MOST = 160  # characters of a sentence in the headline


def changed_sentence(verdict: Verdict) -> str:
    """Return which figures have changed since the earlier diagnosis, for the headline; "" where none has."""
    names = [_at(title, [place for place, _ in mine]) for title, mine in _by_title(verdict).items()]
    start = "Changed since the earlier diagnosis: "
    return f"{start}{fitting(names, 'and', MOST - len(start)) or 'figures, listed below'}." if names else ""


def changed_lines(verdict: Verdict) -> Iterator[str]:
    """Yield a line for each kind of figure that has changed: where, by how much, and how far it was expected to."""
    for title, mine in _by_title(verdict).items():
        values = "; ".join(f"{place} {_text(figure)}".strip() for place, figure in mine)
        yield f"{title}: {values}"


def _by_title(verdict: Verdict) -> dict[str, list[tuple[str, FittedFigure]]]:
    """Return what it is -> where, and the figure: "viscous friction of J2" is viscous friction, J2."""
    found: dict[str, list[tuple[str, FittedFigure]]] = {}
    for figure in verdict.changed:
        title, place = title_of(figure.name)
        found.setdefault(title, []).append((place, figure))
    return {title: sorted(mine, key=lambda one: one[0]) for title, mine in found.items()}


def _at(title: str, places: list[str]) -> str:
    where = ", ".join(filter(None, places))
    return f"{title} ({where})" if where else title


def _text(figure: FittedFigure) -> str:
    """Return a change in words: of a share of the robot's figure by how much it is larger now, else both values."""
    values = (figure.found, figure.low, figure.high)
    expected = f"{abs(figure.sigmas):.1f} times what was to be expected"
    if not (figure.unit or figure.name.endswith(BEFORE)):
        shares = [100 * ((1 + value) / (1 + figure.earlier) - 1) for value in values]
        change, low, high = shown(shares, "%", (shares[2] - shares[1]) / 2)
        return f"{'' if change.startswith('-') else '+'}{change} % ({low} to {high}; {expected})"
    before, value, low, high = shown((figure.earlier, *values), figure.unit, (figure.high - figure.low) / 2)
    size = f"{value} {unit_name(figure.unit)}".rstrip()
    return f"{size} ({low} to {high}; {expected}) instead of {before}"
