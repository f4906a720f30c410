"""Digests of values: two inputs have the same digest only where they are the same, type by type and bit by bit."""

import struct
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from hashlib import blake2b
from typing import Any

import numpy as np

DIGEST_BYTES = 16  # 128 bits: chance does not make two equal ones


def digest(*parts: Any) -> str:
    """Return the digest of some values, 32 hexadecimal digits.

    Every value enters with its type and its length, so that no two different inputs make the same bytes. Floating-point
    numbers enter by their bits: 0.0 and -0.0 differ, nan equals itself.

    Args:
        parts: None, booleans, numbers, text, bytes, arrays of numbers; tuples, lists, mappings (in their order) and
            dataclasses of these.

    Raises:
        TypeError: A value of another type, of which nobody can say when it is the same.
    """
    state = blake2b(digest_size=DIGEST_BYTES)
    for piece in _pieces(parts):
        state.update(piece)
    return state.hexdigest()


def _pieces(value: Any) -> list[Any]:
    """Return the bytes of a value, in pieces."""
    kind, content = type(value).__name__, None
    if value is None:
        content = b""
    elif isinstance(value, bool | int | np.bool_ | np.integer) and not isinstance(value, np.timedelta64):
        content = str(int(value)).encode()
    elif isinstance(value, float | np.float32):
        kind, content = "float", struct.pack("<d", value)
    elif isinstance(value, str):
        content = value.encode("utf-8", "surrogatepass")
    elif isinstance(value, bytes):
        content = value
    if content is not None:
        return [_head(kind, len(content)), content]
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "biufc":
            raise TypeError(f"arrays of {value.dtype} have no digest; only numbers do")
        shape = ",".join(map(str, value.shape))
        flat = np.ascontiguousarray(value).reshape(-1)
        return [_head(f"array {value.dtype.str} {shape}", flat.nbytes), flat.view(np.uint8).data]
    if isinstance(value, tuple | list):
        items: list[Any] = list(value)
    elif isinstance(value, Mapping):
        items = [part for pair in value.items() for part in pair]
    elif is_dataclass(value) and not isinstance(value, type):
        kind = f"{type(value).__module__}.{type(value).__qualname__}"
        items = [part for field in fields(value) for part in (field.name, getattr(value, field.name))]
    else:
        raise TypeError(f"values of type {kind} have no digest")
    return [_head(kind, len(items)), *(piece for item in items for piece in _pieces(item))]


def _head(kind: str, length: int) -> bytes:
    name = kind.encode()
    return struct.pack("<QQ", len(name), length) + name
