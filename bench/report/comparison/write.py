"""The files of a comparison: compare.json and report.html."""

import json
from pathlib import Path

from bench.compare.comparison import Comparison
from bench.report.comparison.page import page_of
from bench.report.jsonable import to_jsonable

COMPARISON = "compare.json"
REPORT = "report.html"


def write_comparison(comparison: Comparison, folder: Path, robot: str, command: str = "") -> None:
    """Write the files of a comparison into an existing folder.

    Args:
        comparison: What to write.
        folder: Where to.
        robot: Title of the robot.
        command: That made it, for the page.
    """
    content = json.dumps(to_jsonable(comparison.as_json()), indent=2) + "\n"
    (folder / COMPARISON).write_text(content, encoding="utf-8")
    (folder / REPORT).write_text(page_of(comparison, robot, command), encoding="utf-8")
