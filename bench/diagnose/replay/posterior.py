"""What a diagnosis knows of figures and findings: plain data, for the next one (`given.py`)."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from bench.record.campaign import Array


@dataclass(frozen=True)
class PosteriorParameter:
    """A figure, or the size of a finding.

    Attributes:
        name: For people.
        unit: "" for a relative deviation.
        sigma: Standard deviation of its prior, in its unit.
        found: As fitted.
        effect, place, parameter: Of a finding, as `fitted.effects` has them; "" for a figure.
        shapes: Of a finding, parameters that shape it.
        before: Of a figure that an earlier diagnosis left already: what that had found (`Earlier.found`).
    """

    name: str
    unit: str
    sigma: float
    found: float
    effect: str = ""
    place: str = ""
    parameter: str = ""
    shapes: Mapping[str, float] = field(default_factory=dict)
    before: float = 0.0

    @property
    def is_share(self) -> bool:
        """Whether a further deviation is a share of what was found."""
        return self.parameter in ("", "change") and self.unit == ""


@dataclass(frozen=True, eq=False)
class Posterior:
    """What a diagnosis knows; n parameters.

    Attributes:
        parameters: Figures, then sizes of findings.
        covariance: Shape (n, n), in standard deviations of their priors.
    """

    parameters: tuple[PosteriorParameter, ...]
    covariance: Array
