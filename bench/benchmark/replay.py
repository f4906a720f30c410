"""Replay in C against the same search in NumPy, along the motions of one campaign."""

from collections.abc import Sequence

import numpy as np

from bench.benchmark.campaigns import hidden_gas_loss
from bench.benchmark.clock import interleaved
from bench.benchmark.section import Row
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.segments import segments_of
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.simulate.prescribed import Motion, Prescribed
from bench.simulate.reference_replay import Reference

ROUNDS = 5


def measure(robots: Sequence[str]) -> list[Row]:
    """Return what one world takes, without a payload; names of robots are not used."""
    campaign = hidden_gas_loss()
    compiled = compile_robot(load_robot(campaign.robot))
    segments = segments_of(campaign, compiled, quantities_of(campaign.runs, compiled))
    motions = [segment.motion for segment in segments if segment.conditions.payload_kg == 0]
    joined = Motion.concatenate(motions)
    in_c, in_numpy = Prescribed(compiled), Reference(compiled)
    guess = in_c.follow(joined)[1]
    parts = np.split(guess, np.cumsum([len(motion) for motion in motions])[:-1])

    def numpy() -> None:
        for motion, known in zip(motions, parts, strict=True):
            in_numpy.follow(motion, known)

    spent = np.median(interleaved([lambda: in_c.follow(joined, guess), numpy], ROUNDS), axis=0)
    name = f"{len(joined)} instants of {len(motions)} motions"
    return [
        Row(f"{name}, C", float(spent[0]), "s", float(spent[1] / spent[0]), "times as fast as NumPy"),
        Row(f"{name}, NumPy", float(spent[1]), "s"),
    ]
