"""How time grows with rows, runs and candidates: doubling each, and the exponent of the growth."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bench.benchmark.campaigns import hidden_gas_loss, with_rows, with_runs
from bench.benchmark.clock import exponent, interleaved
from bench.benchmark.section import Row
from bench.diagnose.explain import measured_by
from bench.diagnose.linearise.candidates import causes_of
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting, Effect
from bench.record.campaign import Campaign
from bench.record.check import check_campaign
from bench.record.write import TableFormat, write_campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot

ROWS = (40_000, 80_000, 160_000)  # enough that what a check costs once does not count
RUNS = (125, 250, 500)
REPLAYED = (8, 16, 32)  # runs
CANDIDATES = (16, 32, 64)
ROUNDS = 5


def measure(robots: Sequence[str]) -> list[Row]:
    """Return the time at the largest size, and as the ratio the exponent of growth; names of robots are not used."""
    campaign = hidden_gas_loss()
    compiled = compile_robot(load_robot(campaign.robot))
    return [*_check(campaign, compiled), *_replay(campaign, compiled)]


def _check(campaign: Campaign, compiled: CompiledRobot) -> list[Row]:
    rows = []
    with TemporaryDirectory() as folder:

        def at(place: Path, sized: Campaign, suffix: TableFormat) -> Callable[[], object]:
            write_campaign(sized, place, suffix)
            return partial(check_campaign, place)

        for suffix in ("csv", "parquet"):
            works = [at(Path(folder) / f"rows-{suffix}-{n}", with_rows(campaign, n), suffix) for n in ROWS]
            rows.append(_grown(f"read and rules, rows in {suffix}", ROWS, works))
        works = [at(Path(folder) / f"runs-{n}", with_runs(campaign, n), "csv") for n in RUNS]
        rows.append(_grown("read and rules, runs", RUNS, works))
    works = [partial(doubts_of, with_runs(campaign, n), compiled) for n in RUNS]
    return [*rows, _grown("doubts about channels, runs", RUNS, works)]


def _replay(campaign: Campaign, compiled: CompiledRobot) -> list[Row]:
    quantities, effects = quantities_of(campaign.runs, compiled), catalogue()
    causes = causes_of(effects.values(), compiled, measured_by(campaign))
    works: list[Callable[[], object]] = []
    for n in REPLAYED:
        segments = segments_of(with_runs(campaign, n), compiled, quantities)
        works.append(
            partial(_predict_another, Replay(compiled, segments, quantities), effects["coulomb_level"], count())
        )
    rows = [_grown("replay, runs", REPLAYED, works)]
    few = segments_of(with_runs(campaign, REPLAYED[0]), compiled, quantities)

    some = causes[:: len(causes) // CANDIDATES[0]][: CANDIDATES[0]]

    def signatures_of(n: int) -> None:
        repeated = some * (n // len(some))  # the same ones again: one kind of cause costs more than another
        Signatures(compiled, quantities, (), repeated).sensitivities(few)

    works = [partial(signatures_of, n) for n in CANDIDATES]
    return [*rows, _grown("signatures, candidates", CANDIDATES, works)]


def _predict_another(replay: Replay, effect: Effect, number: Iterator[int]) -> None:
    """Predict a world that was never asked for: what is known already would cost nothing."""
    place = effect.places(replay.compiled)[0]
    replay.predict(World(acting=(Acting(effect, place, {"change": 0.1 + 1e-3 * next(number)}),)))


def _grown(name: str, sizes: Sequence[int], works: Sequence[Callable[[], object]]) -> Row:
    spent = np.median(interleaved(works, ROUNDS), axis=0)
    words = f"exponent of growth from {sizes[0]} to {sizes[-1]}; 1 is linear"
    return Row(f"{name}: {sizes[-1]}", float(spent[-1]), "s", exponent(sizes, spent), words)
