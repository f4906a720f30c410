"""Print what came of every variant: python -m tests.poison [SEED]."""

import argparse
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.poison.run import SEED, run, variants, write_base


def main() -> int:
    """Run all; return 1 if one of them went wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.poison", description=__doc__)
    parser.add_argument("seed", type=int, nargs="?", default=SEED, help="of all that is random (default: %(default)s)")
    seed = parser.parse_args().seed
    count: Counter[str] = Counter()
    families: set[str] = set()
    slowest = 0.0
    with TemporaryDirectory() as place:
        base = write_base(Path(place))
        for variant in variants(seed):
            outcome = run(variant, base)
            count[outcome.kind] += 1
            families.add(variant.family)
            slowest = max(slowest, outcome.seconds)
            if outcome.kind != "right":
                said = " | ".join(outcome.said.strip().splitlines()[-3:])[-400:]
                print(f"{outcome.kind:10}{variant.family}: {variant.name} ({variant.answer} {variant.places}): {said}")
    kinds = ", ".join(f"{count[kind]} {kind}" for kind in ("right", "wrong", "silent", "traceback", "hang"))
    print(f"seed {seed}: {sum(count.values())} variants in {len(families)} families: {kinds}; slowest {slowest:.1f} s")
    return int(count["right"] < sum(count.values()))


if __name__ == "__main__":
    sys.exit(main())
