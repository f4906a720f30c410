"""JSON that a diagnosis wrote into a robot folder, which somebody else may hand on."""

import json
from pathlib import Path
from typing import Any

from bench.record.limits import JSON_BYTES
from bench.record.plain_file import FileFault, read_plain


def load_json(path: Path) -> Any:
    """Return what a file holds.

    Raises:
        ValueError: It is not UTF-8, not JSON, nested too deep, no plain file, or larger than is read.
    """
    try:
        return json.loads(read_plain(path, JSON_BYTES).decode("utf-8"))
    except FileFault as fault:
        raise ValueError(f"{fault}; {fault.remedy}") from fault
    except RecursionError as error:
        raise ValueError("brackets in brackets, thousands deep") from error
