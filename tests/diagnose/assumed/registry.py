"""What each assumed number is there for: checks that hold with it and fail with half of it or twice as much."""

from collections.abc import Callable

Check = Callable[[], None]
CHECKS: dict[str, Check] = {}


def needs(words: str) -> Callable[[Check], Check]:
    """Register a check of a constant, by its module below `bench.diagnose` (or `bench`) and its name."""

    def register(check: Check) -> Check:
        assert words not in CHECKS, words
        CHECKS[words] = check
        return check

    return register
