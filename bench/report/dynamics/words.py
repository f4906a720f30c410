"""What a first pass is compared with, in which unit, and what it holds out at a time, in words."""

from bench.identify.dynamics.found import FirstPass

MODELS = {  # of `Torques` -> what they are called
    "measured": "torque itself",
    "nominal": "nominal model",
    "rival": "plain least squares",
    "first_pass": "first pass",
}
UNITS = {"recording": "recordings", "run": "whole runs", "block": "blocks of time"}


REPETITION = (
    "What was held out goes over the same angles as the rest, so its errors tell how well a repetition is predicted, "
    "not another motion"
)


def torque_unit(found: FirstPass) -> str:
    """Return the unit of the torques of all drives; slides have forces."""
    hinge = found.nominal.bodies.is_hinge
    return "Nm" if hinge.all() else "Nm or N" if hinge.any() else "N"


def folds_words(found: FirstPass) -> str:
    """Return how many folds there are and what they are made of; runs over the same angles are held out together."""
    count, by = len(found.folds), found.folds.by
    runs = len({part.samples.run for part in found.stretches})
    if by == "run" and runs != count:
        return f"{runs} whole runs in {count} groups (those over the same angles together)"
    return f"{count} {UNITS[by]}"
