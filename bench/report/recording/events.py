"""The events of an experiment in a Rerun recording, as a text log."""

from collections.abc import Sequence

from bench.report.recording.writer import TIMELINE, RecordingWriter


def log_events(writer: RecordingWriter, events: Sequence[tuple[float, str]]) -> None:
    """Log events, each (time [s], words)."""
    import rerun as rr

    if events:
        times = [time for time, _ in events]
        lines = [f"{time:8.1f} s   {text}" for time, text in events]
        writer.stream.send_columns(
            "events", indexes=[rr.TimeColumn(TIMELINE, duration=times)], columns=rr.TextLog.columns(text=lines)
        )
