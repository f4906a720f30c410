"""`bench benchmark`: what the bench costs, in processor time."""

import json
import sys
from dataclasses import asdict, dataclass

import tyro


@dataclass(frozen=True)
class Benchmark:
    """Processor time of what counts, and ratios within one run, so that other work on the machine hardly matters."""

    robots: tyro.conf.Positional[tuple[str, ...]] = ()
    """Names of robot folders, or paths to them, for actuators and environment; none: all that come along."""
    only: tuple[str, ...] = ()
    """Sections to measure (bench/benchmark/README.md); none: all of them."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Measure and print; return the exit code."""
        from importlib.util import find_spec

        from bench.benchmark.sections import SECTIONS
        from bench.errors import InputError, unknown_names

        if problems := unknown_names("section", self.only, SECTIONS):
            raise InputError(problems)
        found: dict[str, list[dict[str, object]]] = {}
        for name in self.only or SECTIONS:
            section = SECTIONS[name]
            package, extra = section.needs
            if package and find_spec(package) is None:
                print(f"{name}: left out; pip install 'hh150-bench[{extra}]' brings what it needs", file=sys.stderr)
                continue
            rows = section.measure(self.robots)
            found[name] = [asdict(row) for row in rows]
            if not self.json:
                print(f"{name}: {section.title}")
                for row in rows:
                    against = "" if row.ratio is None else f"   {row.ratio:8.3f}  {row.ratio_to}"
                    print(f"  {row.name:44}{row.value:12.4g} {row.unit:10}{against}".rstrip())
        if self.json:
            print(json.dumps(found, indent=2))
        return 0
