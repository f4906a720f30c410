"""MCAP, the container of ROS 2 bags: one topic as a table. Needs the extra `mcap`.

A message is a row. A number in it is a column, named by its way into the message (`wrench.force.x`); a list of numbers
is a column for each place, named by the list `name` beside it if there is one (`position.elbow`), else by number. Two
clocks stand beside them in seconds: `log_time`, and `header.stamp` where messages have one.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import unknown_name
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.limits import TABLE_BYTES, TABLE_CELLS
from bench.record.plain_file import FileFault, expect_plain
from bench.record.table import Table

MCAP = ".mcap"
NANOSECOND = 1e-9  # [s]


def read_topic(file: Path, topic: str) -> Table:
    """Read one topic of a recording; "" where it has only one. Whatever is wrong with it becomes a finding."""
    try:
        expect_plain(file, TABLE_BYTES)
    except FileFault as fault:
        return _fault(file, str(fault), fault.remedy)
    try:
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory
    except ImportError:
        return _fault(file, "MCAP is not read without the packages for it", "pip install 'hh150-bench[mcap]'")
    rows: list[dict[str, float]] = []
    try:
        with file.open("rb") as stream:
            reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
            summary = reader.get_summary()
            topics = sorted(channel.topic for channel in summary.channels.values()) if summary else []
            if not topic and len(topics) == 1:
                topic = topics[0]
            if topic not in topics:
                hint = (
                    unknown_name("topic", topic, topics) if topic else f"has {len(topics)} topics: {', '.join(topics)}"
                )
                return _fault(file, hint.rstrip("."), "write `topic: NAME` into the log.yaml")
            for _, _, message, content in reader.iter_decoded_messages(topics=[topic]):
                row = {"log_time": message.log_time * NANOSECOND}
                row.update(_numbers(content))
                rows.append(row)
                if TABLE_CELLS.exceeded(len(rows) * len(row)):
                    return _fault(file, f"has more than {TABLE_CELLS}", TABLE_CELLS.remedy)
    except Exception as error:  # noqa: BLE001  its parsers raise whatever a damaged file leads them to
        return _fault(file, f"is no readable MCAP file ({' '.join(str(error).split())[:200]})", "write it again")
    names = tuple(dict.fromkeys(name for row in rows for name in row))
    columns: dict[str, Array] = {name: np.array([row.get(name, np.nan) for row in rows]) for name in names}
    if not names:
        return _fault(file, f"topic {topic} has no messages", "record them, or name another topic")
    return Table(names, columns, ())


def _fault(file: Path, message: str, remedy: str) -> Table:
    return Table((), {}, (Finding("error", file.name, None, "", message, remedy),))


def _numbers(message: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Yield name and value of every number in a message."""
    labels = getattr(message, "name", None)
    for field in message.__slots__:
        value, name = getattr(message, field), f"{path}{field}"
        if isinstance(value, bool | int | float):
            yield name, float(value)
        elif hasattr(value, "sec") and hasattr(value, "nanosec"):
            yield name, value.sec + value.nanosec * NANOSECOND
        elif hasattr(value, "__slots__") and not isinstance(value, str | bytes):
            yield from _numbers(value, f"{name}.")
        elif isinstance(value, list | tuple | np.ndarray):
            listed = labels if isinstance(labels, list) and len(labels) == len(value) else range(1, len(value) + 1)
            for label, item in zip(listed, value, strict=True):
                if isinstance(item, bool | int | float | np.number):
                    yield f"{name}.{label}", float(item)
