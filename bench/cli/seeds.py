"""Seeds of random numbers, as people give them."""

from bench.errors import InputError


def checked_seed(seed: int, option: str = "--seed") -> int:
    """Return a seed.

    Raises:
        InputError: It is negative.
    """
    if seed < 0:
        raise InputError(f"{option} {seed}: a seed is a whole number from 0 on.")
    return seed
