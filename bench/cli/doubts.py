"""What commands do about channels that are hardly what their names say."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bench.record.finding import Finding

WAYS_OUT = (
    "Put this right first: the robot would be blamed for it. A column that cannot be mended is left out when its name "
    "begins with _; if all is as it should be, give --despite-doubts."
)


def heed(
    warnings: "Sequence[tuple[Path, Finding]]", doubts: "Sequence[tuple[Path, Finding]]", *, despite_doubts: bool
) -> None:
    """Print what is to be looked at in campaigns.

    Args:
        warnings: Campaign folder, and finding.
        doubts: The same, of failed plausibility checks.
        despite_doubts: Whether to go on with these.

    Raises:
        CampaignError: Plausibility checks failed, and they are not to be passed over.
    """
    import sys

    from bench.errors import CampaignError

    if doubts and not despite_doubts:
        raise CampaignError([*(f"{folder}: {doubt}" for folder, doubt in _at_a_glance(doubts)), WAYS_OUT])
    for folder, finding in (*_at_a_glance(warnings), *_at_a_glance(doubts)):
        print(f"{finding.label:14}{folder}: {finding}", file=sys.stderr)


def _at_a_glance(findings: "Sequence[tuple[Path, Finding]]") -> Iterator[tuple["Path", "Finding"]]:
    """Yield findings of each folder, the same fault in many places once."""
    from bench.record.logs.likewise import at_a_glance

    for folder in dict.fromkeys(place for place, _ in findings):
        for finding in at_a_glance(one for place, one in findings if place == folder):
            yield folder, finding
