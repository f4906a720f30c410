"""What did not pay on what was held out, and when it may be tried again."""

from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field

from bench.diagnose.name.naming import Finding

MOST_REFUSED = 20  # effort: findings that do not predict better, before they are no more replaced


@dataclass(eq=False)
class Refusals:
    """Findings and free shapes that were refused.

    Attributes:
        findings: Key of a cause -> its finding.
        left: Key of a cause -> findings beside which it did not pay; empty: it never comes back.
        shapes: Names of free shapes.
    """

    findings: dict[Hashable, Finding] = field(default_factory=dict)
    left: dict[Hashable, frozenset[Hashable]] = field(default_factory=dict)
    shapes: set[str] = field(default_factory=set)

    @property
    def allow_more(self) -> bool:
        """Whether more findings may be refused."""
        return len(self.findings) < MOST_REFUSED

    def add(self, finding: Finding, left: frozenset[Hashable]) -> None:
        """Refuse a finding; one that is refused twice is refused for good.

        Args:
            finding: What did not pay.
            left: Keys of the findings that are left.
        """
        key = finding.cause.key
        self.left[key] = frozenset() if key in self.findings else left
        self.findings[key] = finding

    def barred(self, present: frozenset[Hashable]) -> frozenset[Hashable]:
        """Return the keys of what is not tried again: it did not pay beside findings that are all still there.

        Of several findings that do without each other, the one that is refused first may be the one that is needed,
        once the others are refused as well. It gets one more chance.

        Args:
            present: Keys of the findings of a model.
        """
        return frozenset(key for key, others in self.left.items() if others <= present)

    def beside(self, present: frozenset[Hashable]) -> Iterator[Finding]:
        """Yield what was refused and did not come back.

        Args:
            present: Keys of the findings of a model.
        """
        return (finding for key, finding in self.findings.items() if key not in present)
