"""JSON that a diagnosis wrote into a robot folder, which somebody else may hand on.

It is for commands to read, not for people to edit: numbers of it are believed that nobody could check one by one. So
it has a seal, the digest of all that stands in it, and what was changed since it was written is refused. That is no
protection against somebody who means harm; he can write a seal too.
"""

import json
from collections.abc import Iterable, Mapping
from hashlib import blake2b
from pathlib import Path
from typing import Any

from bench.record.limits import JSON_BYTES
from bench.record.plain_file import FileFault, read_plain

SEAL = "seal"
DIGEST_BYTES = 16


def load_json(path: Path) -> Any:
    """Return what a file holds.

    Raises:
        ValueError: It is not UTF-8, not JSON, nested too deep, no plain file, or larger than is read; or a key of it
            is given twice.
    """
    try:
        return json.loads(read_plain(path, JSON_BYTES).decode("utf-8"), object_pairs_hook=_once)
    except FileFault as fault:
        raise ValueError(f"{fault}; {fault.remedy}") from fault
    except RecursionError as error:
        raise ValueError("brackets in brackets, thousands deep") from error


def sealed(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is to be written, with its seal."""
    return {**content, SEAL: _digest(content)}


def expect_sealed(content: Mapping[str, Any]) -> None:
    """Hold what a file holds against its seal; how it is laid out does not matter.

    Raises:
        ValueError: It was changed since it was written.
    """
    own = {key: value for key, value in content.items() if key != SEAL}
    if content.get(SEAL) != _digest(own):
        raise ValueError(f"{SEAL}: is not that of these numbers; somebody changed them since they were written")


def _digest(content: Mapping[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return blake2b(text.encode("ascii"), digest_size=DIGEST_BYTES).hexdigest()


def _once(pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"key {key[:80]!r} occurs twice")
        found[key] = value
    return found
