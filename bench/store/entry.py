"""The file of one entry: named arrays of numbers behind a header and a checksum over everything that follows it.

    magic (16 bytes) | checksum (32 bytes) | length of the header (8 bytes) | header (JSON) | arrays

Nothing is unpickled. An array is written as it lies in memory; blocks that are all zero bits are left out where that
saves space, and a map with one bit for each block says which.
"""

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import blake2b
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC = b"bench store   1\n"  # 16 bytes; the number is the version of the format
CHECKSUM_BYTES = 32
START = len(MAGIC) + CHECKSUM_BYTES
LENGTH = struct.Struct("<Q")
BLOCK = 128  # [bytes], 16 numbers; shorter blocks save a little more and take several times as long
NUMBERS = "biufc"  # kinds of dtypes

Arrays = Mapping[str, NDArray[Any]]


class DamagedEntryError(Exception):
    """A file that is not what was written under this key; it counts as absent."""


@dataclass(frozen=True)
class Head:
    """What an entry says about itself.

    Attributes:
        key: Under which it was written.
        label: For people.
        made_s: When it was written, seconds since 1970.
        arrays: Name, dtype, shape and whether blocks of zeros are left out, of every array in order.
    """

    key: str
    label: str
    made_s: float
    arrays: tuple[tuple[str, str, tuple[int, ...], bool], ...]


def encode(key: str, arrays: Arrays, label: str, made_s: float) -> list[bytes | memoryview]:
    """Return the file of an entry, in pieces.

    Raises:
        TypeError: An array of anything but numbers.
    """
    described: list[tuple[str, str, tuple[int, ...], bool]] = []
    payload: list[bytes | memoryview] = []
    for name, array in arrays.items():
        if array.dtype.kind not in NUMBERS:
            raise TypeError(f"array {name!r} is of {array.dtype}; only numbers are stored")
        raw = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
        used, kept = _without_zeros(raw)
        is_sparse = used.nbytes + kept.nbytes < raw.nbytes
        described.append((name, array.dtype.str, array.shape, is_sparse))
        payload += [used.data, kept.reshape(-1).data] if is_sparse else [raw.data]
    head = json.dumps({"key": key, "label": label, "made_s": made_s, "arrays": described}).encode()
    body = [LENGTH.pack(len(head)), head, *payload]
    return [MAGIC, _checksum(body), *body]


def decode(content: bytes, key: str) -> dict[str, NDArray[Any]]:
    """Return the arrays of an entry; they are read-only.

    Args:
        content: Of the file.
        key: Under which it was found.

    Raises:
        DamagedEntryError: The file is damaged, cut off, of another version or of another key.
    """
    view = memoryview(content)
    if view[: len(MAGIC)] != MAGIC or view[len(MAGIC) : START] != _checksum([view[START:]]):
        raise DamagedEntryError("no entry of this version, or damaged")
    head, at = _head(view)
    if head.key != key:
        raise DamagedEntryError(f"an entry of another key, {head.key}")
    found = {}
    for name, dtype, shape, is_sparse in head.arrays:
        size = prod(shape) * np.dtype(dtype).itemsize
        if is_sparse:
            array, at = _with_zeros(view, at, size)
        else:
            array, at = np.frombuffer(view[at : at + size], np.uint8).copy(), at + size  # aligned
        array = array.view(dtype).reshape(shape)
        array.flags.writeable = False
        found[name] = array
    return found


def head_of(start: bytes) -> Head:
    """Return the header from the first bytes of a file; nothing is checked against the checksum.

    Raises:
        DamagedEntryError: There is none.
    """
    if not start.startswith(MAGIC):
        raise DamagedEntryError("no entry of this version")
    try:
        return _head(memoryview(start))[0]
    except (ValueError, TypeError, KeyError, struct.error) as error:
        raise DamagedEntryError("the header cannot be read") from error


def _head(view: memoryview) -> tuple[Head, int]:
    """Return the header and where the arrays begin."""
    (length,) = LENGTH.unpack_from(view, START)
    first = START + LENGTH.size
    said = json.loads(bytes(view[first : first + length]))
    arrays = tuple((name, dtype, tuple(shape), is_sparse) for name, dtype, shape, is_sparse in said["arrays"])
    return Head(said["key"], said["label"], float(said["made_s"]), arrays), first + length


def _checksum(pieces: list[Any]) -> bytes:
    state = blake2b(digest_size=CHECKSUM_BYTES)
    for piece in pieces:
        state.update(piece)
    return state.digest()


def _without_zeros(raw: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.uint64]]:
    """Return which blocks hold anything, as bits, and those blocks, shape (blocks, BLOCK / 8)."""
    padded = raw if len(raw) % BLOCK == 0 else np.concatenate([raw, np.zeros(-len(raw) % BLOCK, np.uint8)])
    if padded.ctypes.data % 8:
        padded = padded.copy()  # bytes of an odd view; words have to be aligned
    blocks = padded.view(np.uint64).reshape(-1, BLOCK // 8)
    used = blocks.any(axis=1)
    return np.packbits(used), blocks[used]


def _with_zeros(view: memoryview, at: int, size: int) -> tuple[NDArray[np.uint8], int]:
    """Return `size` bytes from the blocks that were kept, and where they end in the file."""
    count = -(-size // BLOCK)
    used = np.unpackbits(np.frombuffer(view[at : at + -(-count // 8)], np.uint8), count=count).astype(bool)
    at += -(-count // 8)
    end = at + int(np.count_nonzero(used)) * BLOCK
    blocks = np.zeros((count, BLOCK), np.uint8)
    blocks[used] = np.frombuffer(view[at:end], np.uint8).reshape(-1, BLOCK)
    return blocks.reshape(-1)[:size], end
