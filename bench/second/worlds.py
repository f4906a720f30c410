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
        on_motors: Share of drives whose motor-side friction is found anywhere between its levels at an arrival.
        on_links: The same of the link side: links rest where friction leaves them.
    """

    travel: float = 1.0
    law: Law = "elasto-plastic"
    gives: bool = False
    on_motors: float = 0.0
    on_links: float = 0.0

    @classmethod
    def draw(cls, rng: np.random.Generator, rests: bool = False) -> Self:
        """Draw a world; `rests`: one in which links come to rest anywhere that friction holds them."""
        travel = float(np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST))))
        law: Law = "dahl" if rng.random() < 0.5 else "elasto-plastic"
        gives, on_motors, on_links = bool(rng.random() < PROPORTIONAL), float(rng.random()), float(rng.random())
        return cls(travel, law, gives, on_motors, on_links if rests else 0.0)

    def of(self, figures: Figures) -> Figures:
        """Return figures as they are in this world."""
        motor, link = (
            replace(friction, stiffness=friction.stiffness / self.travel) for friction in (figures.motor, figures.link)
        )
        decay = np.zeros(figures.n) if self.gives else figures.servo.decay
        return replace(figures, motor=motor, link=link, law=self.law, servo=replace(figures.servo, decay=decay))


QUIET = World()
