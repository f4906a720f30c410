"""A laboratory's own logs become a campaign, or every fault is named in the words of the log."""

import re
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.errors import CampaignError, InputError
from bench.record.campaign import Arm
from bench.record.check import check_campaign
from bench.record.convert import PAUSE_S, convert
from bench.record.log_format import LogFormat, read_log_format
from bench.record.read import read_campaign
from bench.robot.folder import load_robot
from bench.robot.logs import log_format_of
from tests.recordings import write_emps, write_kr300

LAYOUT = LogFormat.model_validate(
    {
        "columns": {
            "time_s": {"from": "t_ms", "factor": 1e-3},
            "q_motor_1_rad": {"from": "axis 1", "factor": -0.5, "offset": 0.1},
            "current_1_a": {"from": "i1", "optional": True},
        },
        "noise": {"current": 0.03},
    }
)
GEAR_2 = 267.42857142857144  # published with the KR300


def log(folder: Path, name: str, text: str) -> Path:
    file = folder / name
    file.write_text(text)
    return file


def test_factor_offset_clock_and_optional_column(tmp_path: Path) -> None:
    file = log(tmp_path, "a b.csv", "t_ms,axis 1,spare\n500,0.2,1\n504,0.4,1\n508,0.5,2\n")
    converted = convert(file, LAYOUT, "mine")
    assert converted.unused == {"a b.csv": ("spare",)}
    assert converted.campaign.robot == "mine"
    assert converted.campaign.noise == {"current": 0.03}
    (run,) = converted.campaign.runs
    assert (run.name, run.kind, run.start_s) == ("a_b", "motion", 0.0)
    np.testing.assert_allclose(run.columns["time_s"], [0, 0.004, 0.008], atol=1e-15)
    np.testing.assert_allclose(run.columns["q_motor_1_rad"], [0.0, -0.1, -0.15])
    assert set(run.columns) == {"time_s", "q_motor_1_rad"}


def test_a_folder_becomes_one_run_for_each_file(tmp_path: Path) -> None:
    for name in ("b.csv", "a.csv", "a b.csv"):
        log(tmp_path, name, "t_ms,axis 1,i1\n0,0.2,1\n4,0.4,2\n8,0.5,3\n")
    log(tmp_path, "README.md", "no log")
    runs = convert(tmp_path, LAYOUT, "mine").campaign.runs
    assert [run.name for run in runs] == ["a_b", "a", "b"]
    np.testing.assert_allclose([run.start_s for run in runs], np.arange(3) * (PAUSE_S + 0.008))
    assert "time of its start is not known" in runs[0].note


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("t_ms,axis1\n0,1\n4,2\n", r"x\.csv: lacks axis 1 \(q_motor_1_rad\); it has 2 columns.*mean 'axis1'"),
        ("t_ms,axis 1\n0,1\n4,\n8,3\n", r"x\.csv: row 2 \(line 3\): axis 1: no value"),
        ("t_ms,axis 1\n0,1\n4,oops\n", r"x\.csv: row 2 \(line 3\): axis 1: 'oops' is no number"),
        ("t_ms,axis 1\n0,1\n4\n", r"x\.csv: row 2 \(line 3\): 1 cells under 2 names"),
        ("t_ms;axis 1\n0;1\n", r"x\.csv: cells are separated by semicolons"),
        ("t_ms,axis 1,axis 1\n0,1,1\n4,2,2\n", r"axis 1: 2 columns have this name"),
        ("t_ms,axis 1\n0,1\n4,2\n4,3\n", r"row 3 \(line 4\): t_ms \(time_s\): is the same as in the row before"),
        ("t_ms,axis 1\n0,1\n4,200\n", r"axis 1 \(q_motor_1_rad\): -99\.9 rad is no position"),
        ("t_ms,axis 1\n", r"x\.csv: holds a header and no rows; record it again, or leave it out"),
        ("", r"is empty"),
    ],
)
def test_faults_are_named(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(CampaignError, match=said):
        convert(log(tmp_path, "x.csv", text), LAYOUT, "mine")


def test_all_faults_of_all_files_at_once(tmp_path: Path) -> None:
    log(tmp_path, "x.csv", "t_ms\n0\n")
    log(tmp_path, "y.csv", "axis 1\n0\n")
    with pytest.raises(CampaignError, match=r"x\.csv: lacks axis 1[\s\S]*y\.csv: lacks t_ms"):
        convert(tmp_path, LAYOUT, "mine")


@pytest.mark.parametrize("source", ["nowhere", "empty"])
def test_no_log(tmp_path: Path, source: str) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(CampaignError, match=re.escape(str(tmp_path / source))):
        convert(tmp_path / source, LAYOUT, "mine")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("columns: {q_motor_1_deg: {from: a}}", r"write 'q_motor_1_rad'"),
        ("columns: {q_moter_1_rad: {from: a}}", r"unknown column 'q_moter_1_rad'.*mean 'q_motor_1_rad'"),
        (
            "columns: {time_s: {from: a, gain: 2}}",
            r"columns\.time_s\.gain: unknown key 'gain'\. Known: factor, fill, from",
        ),
        ("columns: {time_s: {form: a}}", r"columns\.time_s\.form: unknown key 'form'\. Did you mean 'from'\?"),
        (
            "colums: {time_s: {from: a}}",
            r"colums: unknown key 'colums'\. Did you mean 'columns'\? Known: columns, kind",
        ),
        (
            "columns: {time_s: {from: a}}\ntables: {force: {time_s: {from: a}, fil: b}}",
            r"tables\.force\.fil: unknown key 'fil'\. Did you mean 'file'\?",
        ),
        ("columns: {time_s: {from: a}}\nruns: {window_s: [[1, 2]]}", r"runs\.window_s: .* Did you mean 'windows_s'\?"),
        ("columns: {time_s: {from: a, factor: two}}", r"columns\.time_s\.factor"),
        ("columns: {time_s: {from: a}}\nnoise: {currant: 1}", r"unknown quantity 'currant'"),
        ("columns: [", r"not YAML"),
        ("kind: motion", r"columns: is missing"),
    ],
)
def test_a_broken_format_is_told_what_is_wrong(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_log_format(log(tmp_path, "log.yaml", text))


def test_a_robot_without_a_format_says_so(small_robot: Path) -> None:
    with pytest.raises(InputError, match=r"log\.yaml: no such file"):
        log_format_of(load_robot(small_robot))
    with pytest.raises(InputError, match="/dev/zero: is a device"):
        log_format_of(load_robot(small_robot), Path("/dev/zero"))


def test_emps_from_log_to_campaign(
    tmp_path: Path, rng: np.random.Generator, capsys: pytest.CaptureFixture[str]
) -> None:
    write_emps(tmp_path / "emps.csv", rng)
    assert main(["convert", "emps", str(tmp_path / "emps.csv"), "-o", str(tmp_path / "campaign")]) == 0
    assert "1 run, 6000 rows, 0 warnings" in capsys.readouterr().out
    assert main(["check", str(tmp_path / "campaign")]) == 0
    (run,) = read_campaign(tmp_path / "campaign").runs
    assert set(run.columns) == {"time_s", "q_cmd_1_m", "q_motor_1_m", "tau_motor_1_n"}


@pytest.mark.parametrize("table_format", ["csv", "parquet"])
def test_kr300_from_log_to_campaign(tmp_path: Path, rng: np.random.Generator, table_format: str) -> None:
    (tmp_path / "logs").mkdir()
    write_kr300(tmp_path / "logs" / "one.csv", rng)
    write_kr300(tmp_path / "logs" / "two.csv", rng)
    extra = ["--parquet"] if table_format == "parquet" else []
    assert main(["convert", "kr300", str(tmp_path / "logs"), "-o", str(tmp_path / "campaign"), *extra]) == 0
    assert check_campaign(tmp_path / "campaign").findings == ()
    campaign = read_campaign(tmp_path / "campaign")
    assert campaign.robot == "kr300"
    assert [run.name for run in campaign.runs] == ["one", "two"]
    logged = np.genfromtxt(tmp_path / "logs" / "two.csv", delimiter=",", names=True)
    run = campaign.runs[1]
    np.testing.assert_allclose(run.columns["tau_motor_2_nm"], GEAR_2 * logged["tau_motor_2_Nm"])
    np.testing.assert_array_equal(run.columns["q_motor_3_rad"], logged["q_motor_3_rad"])


def test_nothing_is_left_behind_by_a_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = log(tmp_path, "emps.csv", "time_s,q_m\n0,1\n")
    code = main(["convert", "emps", str(file), "-o", str(tmp_path / "campaign")])
    assert code == CampaignError.exit_code
    assert "u_V" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["emps.csv"]


MOTOR = "an angle of the motor? divide by the gear ratio"


@pytest.mark.parametrize(
    ("largest", "factor", "ratio", "said", "not_said"),
    [
        (145.0, 1.0, None, "degrees? multiply by pi / 180", "of the motor"),
        (145.0, 1.0, 121.0, f"degrees? multiply by pi / 180; {MOTOR} of the robot's figures, 121", ""),
        (8327.0, 1.0, None, MOTOR, "degrees"),  # 145 rad after it
        (8327.0, 1.0, 121.0, "an angle of the motor in degrees? multiply by pi / 180 and divide by", ""),
        (8327.0, 0.0174532925199, None, MOTOR, "degrees"),
        (8327.0, -0.01745, 121.0, f"{MOTOR} of the robot's figures, 121", "degrees"),
        (8e6, 0.000144, None, "look at its factor", "degrees"),
    ],
)
def test_an_angle_that_reaches_too_far_is_advised_what_brings_it_into_range(
    tmp_path: Path, largest: float, factor: float, ratio: float | None, said: str, not_said: str
) -> None:
    """Degrees were advised to a factor of pi / 180, and where 145 rad would have been left."""
    file = log(tmp_path, "a.csv", f"t,q,i\n0,0,1\n0.1,{largest / 2:g},1\n0.2,{largest:g},2\n")
    columns = {"time_s": {"from": "t"}, "q_motor_1_rad": {"from": "q", "factor": factor}, "current_1_a": {"from": "i"}}
    with pytest.raises(CampaignError) as caught:
        convert(file, LogFormat.model_validate({"columns": columns}), "mine", Arm((False,), ((-3.0, 3.0),), (ratio,)))
    (problem,) = [line for line in str(caught.value).splitlines() if "no position of this joint" in line]
    assert said in problem
    assert not not_said or not_said not in problem


@pytest.mark.parametrize(
    ("factor", "said"), [(1.0, "millimetres? multiply by 0.001"), (0.001, "counts of an encoder? look at its factor")]
)
def test_millimetres_are_not_advised_twice(tmp_path: Path, factor: float, said: str) -> None:
    """Counts of a rail, taken for millimetres, were advised the factor that stood there."""
    file = log(tmp_path, "a.csv", "t,q,i\n0,0,1\n0.1,75000,1\n0.2,150000,2\n")
    columns = {"time_s": {"from": "t"}, "q_motor_1_m": {"from": "q", "factor": factor}, "current_1_a": {"from": "i"}}
    with pytest.raises(CampaignError) as caught:
        convert(file, LogFormat.model_validate({"columns": columns}), "mine", Arm((True,), ((-1.5, 1.5),), (None,)))
    (problem,) = [line for line in str(caught.value).splitlines() if "no position of this joint" in line]
    assert said in problem


@pytest.mark.parametrize(
    ("first", "others", "said", "not_said"),
    [
        (6 * np.pi, 1.0, "a counter that stands 3 turns on? add the offset -18.849556", "degrees"),
        (-4 * np.pi, 1.0, "a counter that stands 2 turns back? add the offset 12.566371", "degrees"),
        (6 * np.pi, 60.0, "a counter that stands 3 turns on? add the offset -18.849556; degrees?", ""),  # all of them?
    ],
)
def test_a_counter_of_a_joint_with_a_turn_to_go_may_be_some_turns_on(
    tmp_path: Path, first: float, others: float, said: str, not_said: str
) -> None:
    """It was advised degrees, of one angle of three."""
    rows = "".join(f"{k / 10},{first + 0.3 * k:.7g},{others:g},{0.5 * others:g},1\n" for k in range(3))
    file = log(tmp_path, "a.csv", f"t,q1,q2,q3,i\n{rows}")
    columns = {"time_s": {"from": "t"}, "current_1_a": {"from": "i"}}
    columns |= {f"q_motor_{j}_rad": {"from": f"q{j}"} for j in (1, 2, 3)}
    arm = Arm((False,) * 3, ((-2 * np.pi, 2 * np.pi), (-3.0, 3.0), (-3.0, 3.0)), (None,) * 3)
    with pytest.raises(CampaignError) as caught:
        convert(file, LogFormat.model_validate({"columns": columns}), "mine", arm)
    (problem,) = [line for line in str(caught.value).splitlines() if "q_motor_1_rad" in line]
    assert said in problem
    assert not not_said or not_said not in problem
