"""What pydantic finds wrong with a value, in the words of people who write such files."""

from collections.abc import Mapping
from typing import Any

BLOCK = "is no list of `key: value` lines"
WORDS: Mapping[str, str] = {
    "missing": "is missing",
    "model_type": BLOCK,
    "dict_type": BLOCK,
    "list_type": "is no list",
    "tuple_type": "is no list",
    "string_type": "is no text",
    "string_pattern_mismatch": "has characters that may not stand here",
}


def words_of(detail: Mapping[str, Any]) -> str:
    """Return what is wrong, from an entry of `pydantic.ValidationError.errors()`."""
    return WORDS.get(detail["type"], str(detail["msg"]).removeprefix("Value error, "))
