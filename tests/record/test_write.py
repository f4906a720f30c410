"""A folder is there complete or not at all."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.errors import CampaignError, InputError
from bench.record import write
from bench.record.campaign import Arm, Campaign, Run
from bench.record.folder import new_folder
from bench.record.read import read_campaign
from bench.record.table import FORMATS, Format
from bench.record.write import write_campaign
from tests.record.build import motion, session, static, sweep


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_layout(tmp_path: Path) -> None:
    write_campaign(session(), tmp_path / "new" / "campaign")
    folder = tmp_path / "new" / "campaign"
    assert sorted(str(path.relative_to(folder)) for path in folder.rglob("*.*")) == [
        "campaign.yaml",
        "runs/loading.csv",
        "runs/sweep.csv",
    ]
    assert (folder / "runs" / "loading.csv").read_text().splitlines()[1].startswith("0,1,1,0,1,0,0.3,")
    assert names_in(tmp_path / "new") == ["campaign"]


def test_folder_is_as_open_as_any_other(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    write_campaign(session(), tmp_path / "campaign")
    assert (tmp_path / "campaign").stat().st_mode == (tmp_path / "other").stat().st_mode


def test_empty_folder_is_used(tmp_path: Path) -> None:
    (tmp_path / "campaign").mkdir()
    write_campaign(session(), tmp_path / "campaign")
    assert names_in(tmp_path) == ["campaign"]


def test_folder_in_use_is_refused_unless_replaced(tmp_path: Path) -> None:
    folder = tmp_path / "campaign"
    write_campaign(session(1), folder)
    with pytest.raises(InputError, match="is not empty"):
        write_campaign(session(2), folder)
    write_campaign(session(2), folder, "parquet", replace=True)
    assert names_in(folder / "runs") == ["loading.parquet", "sweep.parquet"]
    assert names_in(tmp_path) == ["campaign"]


def test_only_campaigns_are_replaced(tmp_path: Path) -> None:
    (tmp_path / "photographs").mkdir()
    (tmp_path / "photographs" / "one.jpg").touch()
    with pytest.raises(InputError, match="is not replaced"):
        write_campaign(session(), tmp_path / "photographs", replace=True)
    assert names_in(tmp_path / "photographs") == ["one.jpg"]


def test_file_in_the_way_is_refused(tmp_path: Path) -> None:
    (tmp_path / "campaign").touch()
    with pytest.raises(InputError, match="is a file"):
        write_campaign(session(), tmp_path / "campaign")


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError, MemoryError])
@pytest.mark.parametrize("is_replaced", [False, True])
def test_nothing_half_written_stays(
    error: type[BaseException], is_replaced: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "campaign"
    if is_replaced:
        write_campaign(session(1), folder)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}

    def fail_at_second_table(path: Path, columns: object) -> None:
        if path.name == "sweep.csv":
            path.write_text("half")
            raise error
        path.touch()

    broken = {".csv": Format(FORMATS[".csv"].read, fail_at_second_table)}
    monkeypatch.setattr(write, "FORMATS", broken)
    with pytest.raises(error):
        write_campaign(session(2), folder, replace=is_replaced)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
    assert names_in(tmp_path) == (["campaign"] if is_replaced else [])


def test_replaced_folder_comes_back_if_the_new_one_cannot_be_moved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "campaign"
    write_campaign(session(), folder)
    rename = Path.rename

    def interrupted(self: Path, target: Path) -> Path:
        if self.name.endswith(".partial"):
            raise KeyboardInterrupt
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_campaign(session(), folder, replace=True)
    assert names_in(tmp_path) == ["campaign"]
    assert len(read_campaign(folder).runs) == 2


def test_folder_filled_by_somebody_else_meanwhile_is_kept(tmp_path: Path) -> None:
    def write_while_somebody_else_does() -> None:
        with new_folder(tmp_path / "campaign", "m", replace=False) as partial:
            (partial / "mine").touch()
            (tmp_path / "campaign").mkdir()
            (tmp_path / "campaign" / "theirs").touch()

    with pytest.raises(InputError, match="meanwhile"):
        write_while_somebody_else_does()
    assert names_in(tmp_path) == ["campaign"]
    assert names_in(tmp_path / "campaign") == ["theirs"]


BROKEN = {
    "no runs": (Campaign("small", ()), "at least one run"),
    "no robot": (Campaign("", (motion(sweep()),)), "robot"),
    "run name": (Campaign("small", (motion(sweep(), "../up"),)), "runs[0].name"),
    "same name": (Campaign("small", (motion(sweep()), motion(sweep(), start_s=99.0))), "two runs"),
    "unknown noise": (Campaign("small", (motion(sweep()),), noise={"luck": 1.0}), "unknown quantity"),
    "column": (Campaign("small", (motion(sweep() | {"oil": sweep()["time_s"]}),)), "unknown column"),
    "nan": (Campaign("small", (motion(sweep() | {"q_cmd_1_rad": np.full(2500, np.nan)}),)), "no value"),
    "labels": (Campaign("small", (static(sweep()),)), "missing from a static run"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_could_not_be_read_is_not_written(name: str, tmp_path: Path) -> None:
    campaign, words = BROKEN[name]
    with pytest.raises(CampaignError) as caught:
        write_campaign(campaign, tmp_path / "campaign")
    assert words in str(caught.value)
    assert names_in(tmp_path) == []


def test_run_is_read_only_and_keeps_its_own_numbers() -> None:
    mine = np.zeros(3)
    run = Run("a", "motion", 0.0, {"time_s": mine})
    mine[0] = 1.0
    assert run.columns["time_s"][0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        run.columns["time_s"][0] = 1.0
    assert len(run) == 3
    assert len(replace(run, columns={})) == 0


def test_run_with_columns_of_several_lengths_is_refused() -> None:
    with pytest.raises(CampaignError, match="one length"):
        Run("a", "motion", 0.0, {"time_s": np.zeros(3), "current_1_a": np.zeros(2)})


def test_stack_fills_missing_columns_with_nan() -> None:
    run = Run("a", "motion", 0.0, {"force_x_n": np.ones(2), "force_z_n": np.zeros(2)})
    np.testing.assert_array_equal(run.stack("force", "n", ("x", "y", "z")), [[1, np.nan, 0]] * 2)


def test_arm_needs_limits_for_each_joint() -> None:
    with pytest.raises(CampaignError, match="2 joints cannot have 1"):
        Arm((False, True), ((0.0, 1.0),))


def test_who_comes_second_is_told(tmp_path: Path) -> None:
    def fill_what_another_fills() -> None:
        with new_folder(tmp_path / "a", "x", replace=False):
            (tmp_path / "a").mkdir()
            (tmp_path / "a" / "x").touch()

    with pytest.raises(InputError, match="was filled by somebody else meanwhile"):
        fill_what_another_fills()
    assert names_in(tmp_path) == ["a"]


def test_a_place_where_no_folder_can_be_is_told() -> None:
    with pytest.raises(InputError, match="cannot be written"), new_folder(Path("/proc/x"), "x", replace=False):
        pass
