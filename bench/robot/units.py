"""Units of lists that hold hinges and slides."""

from collections.abc import Iterable


def unit_of(of_hinge: str, of_slide: str, is_slide: Iterable[bool]) -> str:
    """Return the unit of a list of joints: that of hinges, that of slides, or both: "Nm, of a slide N"."""
    kinds = set(map(bool, is_slide))
    return f"{of_hinge}, of a slide {of_slide}" if len(kinds) > 1 else of_slide if True in kinds else of_hinge
