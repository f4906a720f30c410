"""Truth comes back as it was, and stays out of campaigns."""

from pathlib import Path

import numpy as np
import pytest

from bench.errors import CampaignError, InputError
from bench.record.truth import TrueValue, Truth, read_truth, write_truth
from bench.record.write import write_campaign
from tests.record.build import session

TRUTH = Truth(
    parameters={"gas.exponent": TrueValue(1.3, ""), "joint2.stiffness": TrueValue(2.1e6, "Nm/rad")},
    effects=("gas exponent",),
    runs={"sweep": {"time_s": np.array([0.0, 0.1]), "spring_2_nm": np.array([1 / 3, np.nan])}},
)


def test_round_trip_is_exact(tmp_path: Path) -> None:
    write_truth(TRUTH, tmp_path / "truth")
    again = read_truth(tmp_path / "truth")
    assert again.parameters == TRUTH.parameters
    assert again.effects == TRUTH.effects
    assert list(again.runs) == ["sweep"]
    for name, values in TRUTH.runs["sweep"].items():
        np.testing.assert_array_equal(again.runs["sweep"][name], values)


def test_null_data_have_no_effects(tmp_path: Path) -> None:
    write_truth(Truth(), tmp_path / "truth")
    assert read_truth(tmp_path / "truth") == Truth()


@pytest.mark.parametrize("inside", [".", "truth", "deep/down"])
def test_truth_is_kept_out_of_campaigns(inside: str, tmp_path: Path) -> None:
    write_campaign(session(), tmp_path / "campaign")
    with pytest.raises(InputError, match="kept apart"):
        write_truth(TRUTH, tmp_path / "campaign" / inside)
    assert sorted(path.name for path in (tmp_path / "campaign").iterdir()) == ["campaign.yaml", "runs"]


def test_damaged_truth_is_named(tmp_path: Path) -> None:
    write_truth(TRUTH, tmp_path / "truth")
    (tmp_path / "truth" / "runs" / "sweep.csv").write_text("time_s\nnow\n")
    with pytest.raises(CampaignError, match=r"sweep.csv: row 1 \(line 2\): time_s"):
        read_truth(tmp_path / "truth")
    (tmp_path / "truth" / "truth.yaml").write_text("format: 1\nparameters: {a: {value: x}}\nextra: 1\n")
    with pytest.raises(CampaignError) as caught:
        read_truth(tmp_path / "truth")
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize("name", ["sweep/", "../sweep", ""])
def test_runs_of_a_truth_have_names(name: str, tmp_path: Path) -> None:
    """A name that ends in a slash ended in a KeyError."""
    write_truth(TRUTH, tmp_path / "truth")
    file = tmp_path / "truth" / "truth.yaml"
    file.write_text(file.read_text().replace("- sweep", f'- "{name}"'))
    with pytest.raises(CampaignError, match=r"truth.yaml: runs.0: has characters"):
        read_truth(tmp_path / "truth")


def test_missing_truth_is_named(tmp_path: Path) -> None:
    with pytest.raises(CampaignError, match=r"truth.yaml: cannot be read"):
        read_truth(tmp_path)
