"""A spec as MJCF text that compiles to the same numbers."""

from threading import Lock

import mujoco

from bench.robot.patching.pool import engine

DIGITS = 15  # that every number between decimal text and binary keeps (IEEE 754); MuJoCo writes 6 unless told
_LOCK = Lock()  # the number of digits is one for the whole process


def xml_of(spec: mujoco.MjSpec) -> str:
    """Return a compiled spec as MJCF, with numbers to 15 digits.

    MuJoCo 4.0.0 sets the number of digits by a function of its library that its headers do not declare; the version is
    pinned, and `tests/robot/test_write.py` holds it to that.
    """
    functions = engine()
    with _LOCK:
        before = functions._mjPRIVATE__get_xml_precision()
        functions._mjPRIVATE__set_xml_precision(DIGITS)
        try:
            return str(spec.to_xml())
        finally:
            functions._mjPRIVATE__set_xml_precision(before)
