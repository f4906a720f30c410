"""What friction and protocol would give Fig. 17: the closed form against the paper's two statements."""

import numpy as np
import pytest

from bench.executor.serial import SERIAL
from bench.report.paper.line.fig17 import Left, fig17_sentences, left_over
from bench.report.paper.methods.protocols import PROTOCOLS
from bench.report.paper.methods.study import AS_THE_PAPER, METHODS, Condition, study_methods
from bench.scenario.files import read_as
from bench.scenario.line import Line
from bench.scenario.loading import Loading

SECOND_ORDER = 0.02  # [mm]; the commands of the line, not the deflected angles


def left(x: tuple[float, float], z: tuple[float, float], name: str = "this") -> Left:
    return Left(name, {"x": x[0], "y": 0.0, "z": z[0]}, {"x": x[1], "y": 0.0, "z": z[1]})


def test_a_shared_error_hides_a_difference() -> None:
    found = left(x=(0.5, 0.3), z=(1.0, 0.2))
    assert found.ratio("x") == pytest.approx(0.6)
    assert found.ratio("x", found.hiding) == pytest.approx(0.9)
    assert left(x=(0.5, 0.5), z=(1, 1)).hiding == 0
    assert np.isnan(left(x=(0.0, 0.0), z=(1, 1)).ratio("x"))


def test_conditions_that_give_the_picture_are_named() -> None:
    here = {"x": 0.73, "z": 0.86}
    text = "\n".join(
        fig17_sentences([left((0.5, 0.48), (1.0, 0.3), "friction A"), left((1, 0.1), (1, 0.1), "B")], here)
    )
    assert "0.86 in z and 0.73 in x" in text
    assert "friction A with 0 mm" in text
    assert "B with" not in text
    none = "\n".join(fig17_sentences([left((0.5, 0.5), (1.0, 0.9), "C"), left((1, 0.1), (1, 0.1), "B")], here))
    assert "0 give the paper's picture" in none
    assert "(B;" in none


def test_without_friction_nothing_is_left_by_either_method() -> None:
    analyses = {name: METHODS[name] for name in ("current", "force")} | AS_THE_PAPER
    condition = Condition(friction=0.0, protocol=PROTOCOLS[0])
    results = study_methods(read_as(Loading, "loading"), [condition], 0, lambda done: None, SERIAL, analyses)
    for each in left_over(read_as(Line, "line"), results):
        assert max(*each.force.values(), *each.current.values()) < SECOND_ORDER or "plain" in each.condition
