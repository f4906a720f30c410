"""The files in the folder of a prediction."""

NUMBERS = "prediction.json"
REPORT = "report.html"


def recording_name(number: int, count: int) -> str:
    """Return the Rerun recording of one of several recordings; `number` counts from 1."""
    return "prediction.rrd" if count == 1 else f"prediction_{number}.rrd"
