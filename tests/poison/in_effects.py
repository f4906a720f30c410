"""Effects of one's own that are none: what a class says of itself, and what its methods return."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.poison.variant import Answer, Variant

OWN = """
from bench.effects.effect import Effect, Parameter

class Drag(Effect):
    name = "drag"
    family = "own"
    title = "drag"
    physics = "It drags."
    source = "seen"
    parameters = (Parameter("size", "Nm", 0.0, 1.0, 2.0, "how much"),)

    def edit(self, place, values, conditions):
        return None
"""
LIST = ("effects", "--file", "own.py", "--robot", "robot")


def effects_that_are_none(rng: np.random.Generator) -> Iterator[Variant]:
    """Say of an effect what none has; most were listed, four ended in a traceback."""
    edit, places = "    def edit", "    def places(self, compiled):\n        return "
    for name, (old, new, words) in {
        "nothing wrong": ("", "", ""),
        "a file that ends": ("class Drag", "raise GeneratorExit\nclass Drag", "own.py:4: does not run: GeneratorExit"),
        "a name that is empty": ('"drag"\n    family', '""\n    family', "name '' must be in snake_case"),
        "a name with a value": ('"drag"\n    family', '"drag=1"\n    family', "name 'drag=1' must be in snake_case"),
        "a name with a place": ('"drag"\n    family', '"drag@2"\n    family', "name 'drag@2' must be in snake_case"),
        "a name that steers": ('"drag"\n    family', '"\\x1b[31m"\n    family', "must be in snake_case"),
        "a level of its own": ("family =", "level = 'galaxy'; family =", "level 'galaxy' is unknown"),
        "between of its own": ("family =", "between = 'ever'; family =", "between 'ever' is unknown"),
        "a method of another name": ("def edit(", "def edits(", "does nothing; give it one of edit, torques"),
        "a parameter twice": (",)\n\n", ', Parameter("size", "", 0.0, 1.0, 2.0, "x"))\n\n', "'size' is there twice"),
        "a range of text": ("1.0, 2.0", "'1', 2.0", "'size': null, low, high must be finite numbers"),
        "a range of nan": ("1.0, 2.0", "1.0, float('nan')", "'size': null, low, high must be finite numbers"),
        "a range of inf": ("1.0, 2.0", "1.0, float('inf')", "'size': null, low, high must be finite numbers"),
        "needs of numbers": ("family =", "needs = (1,); family =", "needs must be a tuple of text"),
        "places of nothing": (edit, f"{places}None\n{edit}", "places must return a tuple of Place"),
        "places of text": (
            "    def edit",
            f"{places}('joint 1',)\n    def edit",
            "places must return a tuple of Place",
        ),
    }.items():
        text = OWN.replace(old, new, 1)

        def spoil(folder: Path, text: str = text) -> None:
            (folder / "own.py").write_text(text)

        answer: Answer = "error" if words else "harmless"
        yield Variant("effects that are none", name, spoil, answer, ("own.py", words) if words else ("drag",), LIST)


FAMILIES = (effects_that_are_none,)
