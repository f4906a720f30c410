"""What the benchmark is made of: its clock, its campaigns, its command."""

import json
import time

import numpy as np
import pytest

from bench.benchmark.campaigns import with_rows, with_runs
from bench.benchmark.clock import exponent, interleaved, processor_time
from bench.benchmark.section import Row, Section
from bench.benchmark.sections import SECTIONS
from bench.cli import main
from bench.record.campaign import Campaign, Run
from tests.record.build import loading, sweep

ROUNDING = 1e-12


def test_waiting_is_not_counted() -> None:
    start = processor_time()
    time.sleep(0.2)
    assert processor_time() - start < 0.1


def test_all_works_take_turns() -> None:
    order: list[int] = []
    found = interleaved([lambda: order.append(0), lambda: order.append(1)], rounds=3)
    assert found.shape == (3, 2)
    assert order == [0, 1, 1, 0, 0, 1]


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
def test_exponent_of_growth(power: float) -> None:
    sizes = (10, 20, 40)
    assert exponent(sizes, 3e-3 * np.array(sizes) ** power) == pytest.approx(power, abs=ROUNDING)


def test_campaigns_of_any_size() -> None:
    runs = (
        Run("rest", "static", 0.0, loading()),
        Run("joint2-up", "motion", 500.0, sweep(1)),
        Run("joint2-down", "motion", 600.0, sweep(2)),
    )
    campaign = Campaign("small", runs)
    many = with_runs(campaign, 7)
    assert [len(run) for run in many.runs] == [len(runs[i % 3]) for i in range(7)]
    assert len({run.name for run in many.runs}) == 7
    (long,) = with_rows(campaign, 12_345).runs
    assert len(long) == 12_345
    assert np.all(np.diff(long.columns["time_s"]) > 0)


def test_command_prints_a_table_or_json(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    sections = {
        "one": Section("a section", lambda robots: [Row("speed", 12.0, "m/s", 0.5, "of light")]),
        "two": Section("another", lambda robots: [Row(f"robots {robots}", 1.0, "s")], ("no_such_package", "extra")),
    }
    monkeypatch.setattr("bench.benchmark.sections.SECTIONS", sections)
    assert main(["benchmark"]) == 0
    out, err = capsys.readouterr()
    assert "speed" in out
    assert "0.500  of light" in out
    assert "two: left out; pip install 'hh150-bench[extra]'" in err
    assert main(["benchmark", "--only", "one", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["one"][0]["ratio"] == 0.5
    assert main(["benchmark", "--only", "three"]) == 2


def test_sections_are_documented() -> None:
    from bench import benchmark

    page = next(iter(benchmark.__path__)) + "/README.md"
    with open(page) as file:  # noqa: PTH123
        text = file.read()
    assert all(f"`{name}`" in text for name in SECTIONS)
