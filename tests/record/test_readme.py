"""The page of documentation says what the code does."""

import re
from pathlib import Path

import numpy as np
import pytest

import bench.record
from bench.cli import main
from bench.errors import CampaignError, InputError
from bench.record import limits
from bench.record.channels import CHANNELS, NAMES, parse_column, table
from bench.record.check import check_campaign
from bench.record.read import read_campaign
from bench.record.units import FOREIGN, right_name
from tests.record import page_example

CURRENT_GAIN = 0.021  # relative: sensor and torque constant of the HH-150's figures
CURRENT_SIGMA_A = 0.03  # [A], noise, step and offset
REFLECTOR_SIGMA_M = 1e-3  # [m]; the frame of the tracker, which stands 4 m off, is turned by 0.2 mrad about each axis
README = (Path(bench.record.__file__).parent / "README.md").read_text()


def copied(folder: Path) -> Path:
    """Copy the example of the page into a folder."""
    files = re.findall(r"^`([\w./]+)`\n```\w+\n(.*?)^```", README, re.DOTALL | re.MULTILINE)
    assert [name for name, _ in files] == ["campaign.yaml", "runs/loading.csv"]
    for name, text in files:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize("is_known", [False, True])
def test_bench_check_finds_nothing_in_the_example(
    tmp_path: Path, is_known: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    """It found a current of the wrong sign, a reflector 0.67 m off, and a position of two joints of six."""
    copied(tmp_path)
    if is_known:
        (block,) = re.findall(r"^```yaml\n(known:\n.*?)^```", README, re.DOTALL | re.MULTILINE)
        manifest = tmp_path / "campaign.yaml"
        manifest.write_text(manifest.read_text() + block)
        assert len(read_campaign(tmp_path).known) == 4
    code = main(["check", str(tmp_path)])
    said = capsys.readouterr().out
    assert said.splitlines()[-1] == f"{tmp_path}: 0 errors, 0 warnings; 1 run on hh150"
    assert code == 0


def test_the_numbers_of_the_example_are_those_of_the_nominal_robot(tmp_path: Path) -> None:
    campaign = read_campaign(copied(tmp_path))
    (run,), ideal = campaign.runs, page_example.readings()
    for name in page_example.COLUMNS:
        gain, sigma = (CURRENT_GAIN, CURRENT_SIGMA_A) if name.startswith("current") else (0.0, REFLECTOR_SIGMA_M)
        np.testing.assert_allclose(run.columns[name], ideal.columns[name], rtol=3 * gain, atol=3 * sigma)
    assert page_example.pressure(np.zeros(6)) == pytest.approx(7.0e6, abs=1e5)  # as `known` has it


def test_example_is_a_campaign_without_findings(tmp_path: Path) -> None:
    copied(tmp_path)
    assert check_campaign(tmp_path).findings == ()
    campaign = read_campaign(tmp_path)
    assert campaign.robot == "hh150"
    assert campaign.noise == {"current": 0.03}
    (run,) = campaign.runs
    assert run.note == "load hung by crane"
    np.testing.assert_array_equal(run.load_wrench()[:, 2], [0, 0, -980.665, -980.665])
    np.testing.assert_array_equal(run.load_wrench()[:, [0, 1, 3, 4, 5]], 0)


def test_table_of_columns_is_the_one_of_the_code() -> None:
    assert table() in README


def test_exit_code_is_the_one_of_the_error() -> None:
    assert f"with {CampaignError.exit_code} if it has errors" in README


def test_every_name_of_the_table_is_understood() -> None:
    assert len(set(NAMES)) == len(NAMES)
    for name in NAMES:
        numbered = re.sub(r"_[ik](?=_)", "_12", name)
        column = parse_column(numbered)
        assert column
        assert column.name == numbered
        assert column.index == (12 if numbered != name else 0)
        assert column.channel in CHANNELS


def test_names_that_are_nearly_right_are_not_understood() -> None:
    for name in (
        "q_cmd_0_rad",
        "q_cmd_01_rad",
        "q_cmd_1",
        "Q_cmd_1_rad",
        "q_cmd_1_rad ",
        "load_1_n",
        "reflector_x_m",
        "",
    ):
        assert parse_column(name) is None


def test_foreign_units_lead_to_a_unit_of_the_table() -> None:
    units = {unit for channel in CHANNELS for unit in (channel.unit, channel.slide_unit)}
    assert {foreign.si for foreign in FOREIGN.values()} <= units


def test_foreign_units_come_with_their_factor() -> None:
    assert right_name("q_cmd_1_deg") == ("q_cmd_1_rad", "multiply by 0.017453293")
    assert right_name("reflector_2_x_mm") == ("reflector_2_x_m", "multiply by 0.001")
    assert right_name("load_z_kN") == ("load_z_n", "multiply by 1000")
    assert right_name("load_z_kg") == ("load_z_n", "multiply by 9.80665")
    assert right_name("current_3_mA") == ("current_3_a", "multiply by 0.001")
    assert right_name("gas_pressure_bar") == ("gas_pressure_pa", "multiply by 100000")
    assert right_name("gear_temperature_1_c") == ("gear_temperature_1_k", "add 273.15")
    assert right_name("q_cmd_1_bar") == ("q_cmd_1_rad", "give them in rad")
    assert right_name("speed_1_rad") is None


def test_the_table_of_limits_is_that_of_the_code() -> None:
    assert limits.table() in README


def test_limits_are_raised_by_whole_numbers_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(limits.YAML_DEPTH.variable, "77")
    assert limits.YAML_DEPTH.value == 77
    for text in ("many", "-1", "0", "1e9", "9" * 30, "٣"):
        monkeypatch.setenv(limits.YAML_DEPTH.variable, text)
        with pytest.raises(InputError, match="BENCH_MOST_YAML_DEPTH"):
            assert limits.YAML_DEPTH.value
