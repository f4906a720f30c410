"""Half and twice of every assumed number: which the checks notice. Run `python -m tests.diagnose.assumed`."""

from bench.study.constants import constants_of, set_to
from tests.diagnose.test_assumed import CHECKS, FACTORS


def is_noticed(words: str, factor: float) -> bool:
    """Return whether the check of a constant fails with it multiplied."""
    (constant,) = constants_of(words)
    with set_to(constant, constant.times(factor)):
        try:
            CHECKS[words]()
        except AssertionError:
            return True
    return False


if __name__ == "__main__":
    noticed = {(words, factor): is_noticed(words, factor) for words in CHECKS for factor in FACTORS}
    for (words, factor), is_so in noticed.items():
        print(f"{words} x {factor:g}: {'noticed' if is_so else 'survived'}")
    print(f"noticed: {sum(noticed.values())} of {len(noticed)}, of {len(CHECKS)} constants")
