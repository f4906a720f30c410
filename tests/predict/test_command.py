"""`bench predict`: exit codes, one clear error for each mistake, and files that read back as what was computed."""

import json
import re
import shutil
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.cli.predict import BROKEN
from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.errors import RobotError
from bench.predict.predict import predict
from bench.predict.promises import PROMISES, read_promises, write_promises
from bench.record.campaign import Campaign
from bench.record.write import write_campaign
from bench.report.prediction.file_names import NUMBERS, REPORT
from bench.report.prediction.sentences import rows_of
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot

PROMISE = PredictedError("tau_motor_1_nm", "Nm", "motion", 8, 0.8, 0.1, 10.0, 0.1, 10.0)


@pytest.fixture(scope="module")
def written(campaign: Campaign, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("written") / "june"
    write_campaign(campaign, folder)
    return folder


@pytest.fixture
def model(folder: Path, tmp_path: Path) -> Path:
    """Return the folder of a diagnosis with the robot that it handed over."""
    shutil.copytree(folder, tmp_path / "found" / "robot")
    return tmp_path / "found"


@pytest.mark.parametrize(
    ("low", "high", "code", "said"),
    [
        (0.1, 10.0, 0, "No error is larger than promised (1 of 1 lies in the promised interval)."),
        (
            0.01,
            0.1,
            BROKEN,
            "1 of 1 error is larger than promised: motor torque 1 (0 of 1 lies in the promised interval, 1 above).",
        ),
        (10.0, 20.0, 0, "No error is larger than promised (0 of 1 lies in the promised interval, 1 below)."),
        (np.nan, np.nan, 0, "promises nothing"),
    ],
)
def test_exit_code_says_whether_promises_hold(
    model: Path, written: Path, capsys: pytest.CaptureFixture[str], low: float, high: float, code: int, said: str
) -> None:
    write_promises(model / "robot", [replace(PROMISE, low=low, high=high)])
    assert main(["predict", str(model), str(written)]) == code
    assert said in capsys.readouterr().out


def test_a_robot_that_no_diagnosis_wrote_promises_nothing(
    folder: Path, written: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["predict", str(folder), str(written)]) == 0
    assert "promises nothing" in capsys.readouterr().out


def test_files_hold_what_was_computed(
    model: Path, written: Path, campaign: Campaign, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_promises(model / "robot", [PROMISE])
    out = tmp_path / "out"
    arguments = [str(model), str(written), "-o", str(out), "--free", "encoder_zero", "--free", "torque_offset"]
    assert main(["predict", *arguments]) == 0
    printed = capsys.readouterr().out
    assert sorted(file.name for file in out.iterdir()) == [NUMBERS, "prediction.rrd", REPORT]
    compiled = compile_robot(load_robot(model / "robot"))
    expected = predict(campaign, compiled, compiled, [PROMISE], ("encoder_zero", "torque_offset"))
    (recording,) = expected.recordings
    content = json.loads((out / NUMBERS).read_text())
    assert (content["promised"], content["kept"], content["broken"]) == (1, 1, False)
    assert content["free"] == ["encoder_zero", "torque_offset"]
    (found,) = content["recordings"]
    for entry, channel in zip(found["channels"], recording.channels, strict=True):
        assert entry.pop("answer") == channel.answer
        for key, value in asdict(channel).items():
            if isinstance(value, float) and np.isfinite(value):
                np.testing.assert_allclose(entry[key], value, rtol=1e-9)  # times are written with ten digits
            elif isinstance(value, float):
                assert entry[key] is None
            else:
                assert entry[key] == value
    assert [entry["name"] for entry in found["freed"]] == [figure.name for figure in recording.freed]
    assert found["not_told"] == list(recording.untold)
    page = (out / REPORT).read_text()
    for row in rows_of(recording):
        assert f'<td class="n"><b>{row.rms}</b></td>' in page
        assert re.search(rf"{row.name} +{re.escape(row.rms)}", printed)
    assert page.count("data:image/svg+xml") == 3
    assert "bench predict" in page


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["nobody", "CAMPAIGN"], 4, "unknown robot 'nobody'"),
        (["MODEL", "NOWHERE"], 3, "NOWHERE"),
        (["MODEL", "CAMPAIGN", "--free", "encoder"], 2, "--free encoder: unknown name 'encoder'"),
        (["MODEL", "CAMPAIGN", "--free", "gas_thermometer"], 2, "--free gas_thermometer: nothing to fit"),
        (["MODEL", "CAMPAIGN", "CAMPAIGN"], 2, "is given twice"),
        (["MODEL", "CAMPAIGN", "--nominal", "nobody"], 4, "unknown robot 'nobody'"),
        (["hh150", "CAMPAIGN"], 3, "no angle of drive 3, 4, 5, 6"),
    ],
)
def test_mistakes_end_in_one_named_error(
    model: Path,
    written: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    code: int,
    said: str,
) -> None:
    places = {"MODEL": str(model), "CAMPAIGN": str(written)}
    out = tmp_path / "out"
    assert main(["predict", *(places.get(word, word) for word in arguments), "-o", str(out)]) == code
    assert said in capsys.readouterr().err
    assert [entry.name for entry in tmp_path.iterdir()] == ["found"]


@pytest.mark.parametrize(
    "text", ["{", '{"format": 2, "promises": []}', '{"format": 1, "promises": [{"channel": "a"}]}', "\x00"]
)
def test_broken_promises_are_named(tmp_path: Path, text: str) -> None:
    (tmp_path / PROMISES).write_text(text)
    with pytest.raises(RobotError, match=f"{PROMISES}: "):
        read_promises(tmp_path)


def test_an_interval_whose_ends_are_exchanged_is_refused(tmp_path: Path) -> None:
    """A poisoner's "1e+308 to 0.376" was taken: "less than promised"."""
    write_promises(tmp_path, [replace(PROMISE, low=2.0, high=1.0)])
    with pytest.raises(RobotError, match="the low end, 2, is above the high one, 1"):
        read_promises(tmp_path)


@pytest.mark.parametrize("key", ["low", "high", "rms", "runs", "channel", "unit"])
def test_promises_that_somebody_changed_are_refused(tmp_path: Path, key: str) -> None:
    """A wider interval held, an interval of another channel was left out, and nobody was told."""
    write_promises(tmp_path, [PROMISE])
    content = json.loads((tmp_path / PROMISES).read_text())
    (tmp_path / PROMISES).write_text(json.dumps(content))
    assert read_promises(tmp_path) == (PROMISE,)  # laid out anew, and yet the same
    entry = content["promises"][0]
    entry[key] = f"{entry[key]}x" if isinstance(entry[key], str) else entry[key] * 2
    (tmp_path / PROMISES).write_text(json.dumps(content))
    with pytest.raises(RobotError, match=f"{PROMISES}: seal"):
        read_promises(tmp_path)


def test_promises_that_are_no_file_are_not_taken_for_none(tmp_path: Path) -> None:
    (tmp_path / PROMISES).mkdir()
    with pytest.raises(RobotError, match="is a folder"):
        read_promises(tmp_path)


def test_promises_read_back(tmp_path: Path) -> None:
    promises = (PROMISE, replace(PROMISE, kind="static", runs=1, low=np.nan, high=np.nan, fitted_low=np.nan))
    write_promises(tmp_path, promises)
    first, second = read_promises(tmp_path)
    assert first == PROMISE
    assert np.isnan(second.low)
    assert second.rms == PROMISE.rms
