"""One diagnosis, phase by phase: the campaign of `bench hide gas_loss=0.12`."""

from collections.abc import Sequence

from bench.benchmark.campaigns import hidden_gas_loss
from bench.benchmark.clock import processor_time
from bench.benchmark.section import Row
from bench.diagnose.diagnose import diagnose
from bench.effects.catalogue import catalogue
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot


def measure(robots: Sequence[str]) -> list[Row]:
    """Return what each phase takes, as the diagnosis itself tells when it begins one; names of robots are not used."""
    campaign, effects = hidden_gas_loss(), catalogue()
    start = processor_time()
    begun = [("model and segments", start)]

    def note(words: str) -> None:
        begun.append((words, processor_time()))

    diagnose(campaign, compile_robot(load_robot(campaign.robot)), effects, progress=note)
    end = processor_time()
    spent: dict[str, float] = {}
    for (phase, at), (_, until) in zip(begun, [*begun[1:], ("", end)], strict=True):
        spent[phase] = spent.get(phase, 0.0) + until - at
    rows = [Row(phase, took, "s", took / (end - start), "of all") for phase, took in spent.items()]
    return [*rows, Row("all", end - start, "s")]
