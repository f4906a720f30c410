"""Where the store of a user lies, and how large it may become."""

import os
import re
from pathlib import Path

from platformdirs import user_cache_path

from bench.errors import InputError
from bench.store.store import LIMIT_BYTES, Store

VARIABLE = "BENCH_STORE"  # of the environment; names another folder
LIMIT_FILE = "limit"  # in the folder: bytes, as text
UNITS = {"B": 1, "KB": 10**3, "MB": 10**6, "GB": 10**9, "K": 10**3, "M": 10**6, "G": 10**9}


def store_folder() -> Path:
    """Return the folder of the store: `BENCH_STORE` if it is set, else one in the user's cache."""
    named = os.environ.get(VARIABLE)
    return Path(named) if named else user_cache_path("hh150-bench") / "store"


def open_store() -> Store:
    """Return the user's store with the limit that was set for it; nothing is written."""
    folder = store_folder()
    file = folder / LIMIT_FILE
    try:
        said = file.read_text(encoding="ascii").strip() if file.is_file() else ""  # a pipe would be waited for
    except (OSError, ValueError):
        said = ""
    return Store(folder, int(said) if re.fullmatch(r"\d{1,15}", said) else LIMIT_BYTES)


def limited(store: Store, limit_bytes: int) -> Store:
    """Return the store with another limit, which holds from now on; what exceeds it is removed.

    Raises:
        InputError: The folder cannot be written; then the limit that was holds.
    """
    changed = Store(store.folder, limit_bytes)
    file = store.folder / LIMIT_FILE
    try:
        store.folder.mkdir(parents=True, exist_ok=True)
        with changed.locked():
            file.write_text(str(limit_bytes), encoding="ascii")
    except OSError as error:
        said = error.filename or file  # of a lock that is none, its name
        raise InputError(f"{said}: cannot be written ({error.strerror}); choose a folder with {VARIABLE}") from error
    if why := changed.shrink():
        raise InputError(why)
    return changed


def bytes_of(text: str) -> int:
    """Return a size in bytes from text such as "500MB", "1.5 GB" or "0".

    A number alone is refused: who writes 5 hardly means five bytes, and what exceeds a limit is removed at once.

    Raises:
        InputError: It is none, or has no unit.
    """
    match = re.fullmatch(r"\s*(\d{1,15}(?:\.\d*)?)\s*([KMG]?B?)\s*", text.upper(), re.ASCII)
    if not match:
        raise InputError(f"{text!r} is no size; write for example 500MB or 2GB.")
    number, unit = float(match[1]), match[2]
    if number and not unit:
        raise InputError(f"{text!r} has no unit; write {match[1]}MB or {match[1]}GB, or {match[1]}B for bytes.")
    return round(number * UNITS[unit or "B"])
