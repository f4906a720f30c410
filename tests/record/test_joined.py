"""Several recordings of one machine in one campaign."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.errors import CampaignError, InputError
from bench.record.campaign import Campaign, Run
from bench.record.check import check_campaign
from bench.record.joined import joined, names_of
from bench.record.read import read_campaign
from bench.record.write import write_campaign


def _run(name: str, start_s: float, recording: str = "") -> Run:
    columns = {"time_s": np.arange(5.0), "q_motor_1_rad": np.linspace(0, 0.1, 5), "current_1_a": np.sin(np.arange(5.0))}
    return Run(name, "motion", start_s, columns, recording=recording)


def _campaign(*runs: Run) -> Campaign:
    return Campaign("hh150", runs)


def test_joined_campaigns_are_recordings_that_keep_their_own() -> None:
    both = joined({"a": _campaign(_run("one", 0)), "b": _campaign(_run("one", 0, "may"), _run("two", 0, "june"))})
    assert [run.name for run in both.runs] == ["a.one", "b.one", "b.two"]
    assert both.recordings == ("a", "b.may", "b.june")


def test_one_campaign_stays_as_it_is() -> None:
    alone = _campaign(_run("one", 0))
    assert joined({"a": alone}) is alone


def test_campaigns_of_two_robots_are_refused() -> None:
    with pytest.raises(CampaignError, match="one machine"):
        joined({"a": _campaign(_run("one", 0)), "b": replace(_campaign(_run("one", 0)), robot="other")})


def test_each_recording_has_its_own_clock_and_survives_a_file(tmp_path: Path) -> None:
    written = _campaign(_run("late", 10, "may"), _run("early", 0, "june"), _run("later", 20, "june"))
    write_campaign(written, tmp_path / "c")
    assert not [finding for finding in check_campaign(tmp_path / "c").findings if "began" in finding.message]
    back = read_campaign(tmp_path / "c")
    assert [(run.name, run.recording) for run in back.runs] == [("late", "may"), ("early", "june"), ("later", "june")]


def test_runs_of_one_recording_that_overlap_are_noticed(tmp_path: Path) -> None:
    write_campaign(_campaign(_run("one", 0, "may"), _run("two", 1, "may")), tmp_path / "c")
    assert [finding for finding in check_campaign(tmp_path / "c").findings if "began" in finding.message]


def test_folders_are_called_by_as_much_of_their_path_as_tells_them_apart() -> None:
    folders = [Path("/lab/may/kr"), Path("/lab/june/kr"), Path("/lab/june/emps")]
    assert names_of(folders) == ("may-kr", "june-kr", "emps")
    assert names_of(folders[:1]) == ("kr",)


def test_a_folder_that_is_given_twice_is_refused() -> None:
    with pytest.raises(InputError, match="twice"):
        names_of([Path("/lab/may"), Path("/lab/june/../may")])
