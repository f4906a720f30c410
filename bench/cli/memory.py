"""Memory: what is free goes back to the system, and where there is too little, that is said."""

import ctypes
import resource
import sys

from bench.errors import MORE_MEMORY, UNMAPPED

TRIM, MMAP = -1, -3  # M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of glibc's malloc.h
UNALLOCATED = ("ould not allocate memory", "bad_alloc", "can't start new thread")  # of MuJoCo, C++ and Python
UNKNOWN_IN_C = (
    "Caught an unknown exception!"  # pybind11 of any exception that it does not know, of MuJoCo's allocations
)
LARGE = 1 << 20  # [bytes]; what is larger has pages of its own


def return_what_is_free() -> None:
    """Let the C library give pages of its own to large arrays, and those back as soon as an array is gone.

    By itself glibc raises that limit to 32 MB as arrays come and go, and what lies between two arrays that are kept
    stays with the process: a diagnosis held 600 MB in place of 490, a study of 688 campaigns gigabytes. Elsewhere this
    does nothing.
    """
    if sys.platform == "linux":
        library = ctypes.CDLL(None)
        if hasattr(library, "mallopt"):
            library.mallopt(MMAP, LARGE)
            library.mallopt(TRIM, 4 * LARGE)


def short_of_memory(error: BaseException) -> str:
    """Return the sentence for an error that memory which is short ends in; "" for any other.

    MuJoCo's bindings have no word for memory that they do not get; only where a limit is set is it taken for that.
    """
    words = str(error)
    is_limited = resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY
    signs = (*UNMAPPED, *UNALLOCATED, *((UNKNOWN_IN_C,) if is_limited else ()))
    if not isinstance(error, MemoryError) and not any(sign in words for sign in signs):
        return ""
    return f"there is too little memory{f' ({words})' if words else ''}; {MORE_MEMORY}."
