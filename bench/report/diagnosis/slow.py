"""Words for motion that was not compared, for friction is not at its level there."""

from collections.abc import Sequence

from bench.diagnose.replay.slow_motion import SlowMotion
from bench.report.diagnosis.names import channel_name
from bench.report.diagnosis.numbers import percent, shown, unit_name

MOSTLY = 0.8  # declared: of a drive's motion; where as much is compared, nothing is said


def slow_sentence(slow: Sequence[SlowMotion]) -> str:
    """Return of which drives much is not compared, and what does not show for it; "" of none."""
    said = [_text(one) for one in slow if one.share < MOSTLY]
    if not said:
        return ""
    return (
        f"Slow motion is not compared, nor where drives turn round. What is: {'; '.join(said)}. Errors are of that. "
        "What friction does below (Stribeck effect, presliding) does not show; sweeps at several slow speeds would."
    )


def _text(one: SlowMotion) -> str:
    """Return "motor current 1 54 % of the time, from 0.072 m/s on"."""
    if not one.share:
        return f"{channel_name(one.channel)} nowhere"
    (speed,) = shown((one.slowest,), one.unit, one.slowest / 10)
    return (
        f"{channel_name(one.channel)} {percent(one.share).strip()} of the time, from {speed} {unit_name(one.unit)} on"
    )
