"""A log of readings at rest, known by the names of its columns: a pose, and what tells the readings in it apart."""

from collections.abc import Sequence

from bench.record.look.names import words_of

# Words of a column's name, in the order in which they are looked for; German as in other looks at names
STATES = {
    "pose": ("pose", "station", "stellung"),
    "approach": ("approach", "side", "seite"),
    "load_step": ("step", "load", "stufe"),
    "repeat": ("repeat", "rep", "wiederholung"),
}


def rest_columns(names: Sequence[str]) -> dict[str, str]:
    """Return column of a campaign -> column of the log; empty unless a pose stands beside another of a rest's.

    Args:
        names: Of the columns of a log.
    """
    found: dict[str, str] = {}
    for column, words in STATES.items():
        for word in words:
            alike = [name for name in names if name not in found.values() and words_of(name)[:2].count(word)]
            if alike:
                found[column] = alike[0]
                break
    return found if "pose" in found and len(found) > 1 else {}
