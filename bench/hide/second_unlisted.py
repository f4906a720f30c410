"""What the catalogue does not hold and the first plant does not have: friction of angle and load at once."""

from math import pi

from bench.effects.effect import Effect, Parameter
from bench.effects.places import OnDrive


class AngleLoadFriction(OnDrive):
    """A gear that rubs under load where it runs out."""

    name = "angle_load_friction"
    family = "own"
    title = "friction that depends on load and angle at once"
    physics = "The motor-side level rises by mu |tau| (1 + sin(2 pi q/p)) with the torque tau of the elastic element."
    source = "assumed, for tests; range: that of load_friction"
    parameters = (
        Parameter("coefficient", "", 0.0, 0.01, 0.06, "mu, mean level per transmitted torque"),
        Parameter("period", "rad", pi / 3, pi / 12, 2 * pi, "p", is_shape=True),
    )


def second_unlisted() -> dict[str, Effect]:
    """Return these effects by name."""
    return {kind.name: kind() for kind in (AngleLoadFriction,)}
