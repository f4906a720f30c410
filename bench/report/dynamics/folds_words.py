"""What a first pass holds out at a time, in words."""

from bench.identify.dynamics.first_pass import FirstPass

UNITS = {"recording": "recordings", "run": "whole runs", "block": "blocks of time"}


def folds_words(found: FirstPass) -> str:
    """Return how many folds there are and what they are made of; runs over the same angles are held out together."""
    count, by = len(found.folds), found.folds.by
    runs = len({part.samples.run for part in found.stretches})
    if by == "run" and runs != count:
        return f"{runs} whole runs in {count} groups (those over the same angles together)"
    return f"{count} {UNITS[by]}"
