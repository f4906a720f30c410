"""How friction and servos of the second plant are beside its effects: another draw is another world."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from bench.second.figures import Figures, Law

SHORTEST, LONGEST = 0.5, 3.0  # presliding travel against the nominal one, DESIGN 6.8
PROPORTIONAL = 0.25  # share of worlds whose servos give, assumed


@dataclass(frozen=True)
class World:
    """One world.

    Attributes:
        travel: Presliding travel against the nominal one.
        law: By which friction builds up.
        gives: Servos have no integral action, so they give by torque / kp.
        scatter: Share of drives and sides whose friction is found anywhere between its levels at an arrival.
    """

    travel: float = 1.0
    law: Law = "elasto-plastic"
    gives: bool = False
    scatter: float = 0.0

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Self:
        """Draw a world."""
        travel = float(np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST))))
        law: Law = "dahl" if rng.random() < 0.5 else "elasto-plastic"
        return cls(travel, law, bool(rng.random() < PROPORTIONAL), float(rng.random()))

    def of(self, figures: Figures) -> Figures:
        """Return figures as they are in this world."""
        motor, link = (
            replace(friction, stiffness=friction.stiffness / self.travel) for friction in (figures.motor, figures.link)
        )
        decay = np.zeros(figures.n) if self.gives else figures.servo.decay
        return replace(figures, motor=motor, link=link, law=self.law, servo=replace(figures.servo, decay=decay))


QUIET = World()
