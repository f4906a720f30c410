"""What protocols do in time, in words: the worst of the worlds counts."""

import numpy as np

from bench.report.paper.loading.worlds import WORLDS
from bench.report.paper.methods.in_time import SHOWN, TRIED, InTime, in_time_sentences
from bench.report.paper.methods.protocols import PROTOCOLS


def test_the_worst_world_counts() -> None:
    by_name = {protocol.name: protocol for protocol in PROTOCOLS}
    protocol = by_name["with-load"]
    errors = [dict.fromkeys(SHOWN, np.array([0.01, -0.02, np.nan, 0.03])), dict.fromkeys(SHOWN, np.full(4, -0.1))]
    found = [InTime(world, protocol, error) for world, error in zip(WORLDS, errors, strict=False)]
    (sentence,) = in_time_sentences(found)
    assert sentence.startswith("In time, each joint moving as the load will push it, loads only put on:")
    assert "joint 10.0 %" in sentence
    assert found[0].off("force") == 0.02
    assert set(TRIED) <= set(by_name)
