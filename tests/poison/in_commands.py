"""Commands whose options contradict each other."""

from collections.abc import Iterator

import numpy as np

from tests.poison.variant import Variant


def the_same_twice(rng: np.random.Generator) -> Iterator[Variant]:
    """Give one thing twice; the last one counted."""
    hide = ("hide", "--scenario", "line", "-o", "../out")
    for first, second in (("gas_loss=0.1", "gas_loss=0.2"), ("coulomb_level@2=0.2", "coulomb_level@joint2:change=0.3")):
        command = (*hide, first, second)
        yield Variant("the same twice", f"{first} {second}", lambda folder: None, "error", (second, "twice"), command)


FAMILIES = (the_same_twice,)
