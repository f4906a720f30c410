"""A recording is a valid Rerun file with the robot, its ghost and the curves in it; after an error there is none."""

import subprocess
import sys
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rerun.chunk import RrdReader

import bench.report.recording.write
from bench.errors import InputError
from bench.report.recording.write import write_recording
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.simulate.session import Film
from tests.report.films import EVENTS, FORCES, LENGTH, PART, instants, made_film, without

TEN_MINUTES = 6000  # instants at 10 Hz
LARGEST = 20e6  # [byte], what a session of ten minutes may take
SINGLE_PRECISION = 1e-6

Columns = Mapping[str, Mapping[str, list[Any]]]


def columns_of(path: Path) -> Columns:
    """Return entity path -> column -> one entry per row."""
    columns: dict[str, dict[str, list[Any]]] = defaultdict(lambda: defaultdict(list))
    for chunk in RrdReader(path).stream().to_chunks():
        batch = chunk.to_record_batch()
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            columns[chunk.entity_path][name] += column.to_pylist()
    return columns


@pytest.fixture(scope="module")
def recording(compiled: CompiledRobot, film: Film, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "session.rrd"
    write_recording(path, compiled, film)
    return path


@pytest.fixture(scope="module")
def columns(recording: Path) -> Columns:
    return columns_of(recording)


def verify(path: Path) -> None:
    subprocess.run([sys.executable, "-m", "rerun", "rrd", "verify", str(path)], check=True, capture_output=True)


def test_rerun_verifies_it(recording: Path) -> None:
    verify(recording)


def test_it_opens_in_its_own_layout(recording: Path) -> None:
    """The viewer in a browser opened it in a layout of its own guessing, for the file's was its default alone."""
    printed = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "print", str(recording)], check=True, capture_output=True, text=True
    )
    (line,) = (line for line in printed.stdout.splitlines() if line.startswith("BlueprintActivationCommand"))
    assert "make_active: true, make_default: true" in line


def test_says_what_it_is(recording: Path, compiled: CompiledRobot, columns: Columns) -> None:
    (entry,) = RrdReader(recording).recordings()
    assert entry.application_id == "bench"
    assert len(RrdReader(recording).blueprints()) == 1
    assert columns["/__properties"]["RecordingInfo:name"] == [[compiled.robot.figures.title]]


@pytest.mark.parametrize("arm", ["elastic", "rigid"])
@pytest.mark.parametrize("body", ["upper", "fore"])
def test_bodies_have_a_pose_per_instant_and_their_geoms(columns: Columns, arm: str, body: str) -> None:
    entity = f"/robot/{arm}/{body}"
    assert len(columns[entity]["Transform3D:translation"]) == LENGTH
    assert len(columns[entity]["time"]) == LENGTH
    geoms = [path for path in columns if path.startswith(f"{entity}/")]
    assert len(geoms) == 1
    assert len(columns[geoms[0]]["Capsules3D:lengths"]) == 1


@pytest.mark.parametrize(
    ("path", "component"),
    [
        ("/robot/elastic/counterbalance/housing", "Transform3D:translation"),
        ("/robot/elastic/counterbalance/rod", "Transform3D:translation"),
        ("/robot/elastic/reference_point", "Points3D:positions"),
        ("/robot/rigid/reference_point", "Points3D:positions"),
        ("/robot/rigid/path", "LineStrips3D:strips"),
        ("/robot/elastic/path", "LineStrips3D:strips"),
        ("/robot/load", "Arrows3D:vectors"),
        ("/tracker/head", "Transform3D:quaternion"),
        ("/tracker/line_of_sight", "LineStrips3D:strips"),
        ("/deflection/true\\ x", "Scalars:scalars"),
        ("/deflection/measured\\ z", "Scalars:scalars"),
        ("/force/true\\ z", "Scalars:scalars"),
        ("/current/hinge_b", "Scalars:scalars"),
        ("/wind_up/hinge_a", "Scalars:scalars"),
        ("/motor_torque/hinge_a", "Scalars:scalars"),
        ("/motor_friction/hinge_a", "Scalars:scalars"),
        ("/link_friction/hinge_b", "Scalars:scalars"),
        ("/counterbalance/pull/pull", "Scalars:scalars"),
        ("/counterbalance/length/length", "Scalars:scalars"),
        ("/counterbalance/pressure/pressure", "Scalars:scalars"),
    ],
)
def test_has_one_row_per_instant(columns: Columns, path: str, component: str) -> None:
    rows = [row for row in columns[path][component] if row is not None]
    assert len(rows) == LENGTH


def test_curves_are_in_the_unit_of_their_plot(columns: Columns, film: Film) -> None:
    def curve(path: str) -> np.ndarray:
        return np.array([row[0] for row in columns[path]["Scalars:scalars"] if row is not None])

    wind_up = 1e3 * (film.trace.theta - film.trace.q)[:, 0]
    np.testing.assert_allclose(curve("/wind_up/hinge_a"), wind_up)  # [mrad]
    np.testing.assert_allclose(curve("/counterbalance/pull/pull"), 1e-3 * film.trace.counterbalance_force)  # [kN]
    np.testing.assert_allclose(curve("/counterbalance/pressure/pressure"), 1e-5 * film.reading.gas_pressure)  # [bar]
    np.testing.assert_allclose(curve("/current/hinge_b"), film.reading.current[:, 1])  # [A]


def test_the_arrow_is_there_while_there_is_a_load(columns: Columns) -> None:
    labels = [label for row in columns["/robot/load"]["Arrows3D:labels"] for label in row]
    assert labels == [f"{force:.0f} N" for force in FORCES if force for _ in range(PART)]


def test_events_are_in_the_log(columns: Columns) -> None:
    lines = [row[0] for row in columns["/events"]["TextLog:text"]]
    assert len(lines) == len(EVENTS)
    for line, (time, words) in zip(lines, EVENTS, strict=True):
        assert words in line
        assert f"{time:.1f} s" in line


def test_the_only_timeline_is_seconds(columns: Columns, film: Film) -> None:
    assert not {name for rows in columns.values() for name in rows} & {"log_time", "log_tick"}
    seconds = [time.total_seconds() for time in columns["/current/hinge_a"]["time"]]
    np.testing.assert_allclose(seconds, film.trace.time, atol=1e-9)  # Rerun counts nanoseconds


def test_ghost_and_robot_coincide_at_magnification_zero(compiled: CompiledRobot, film: Film, tmp_path: Path) -> None:
    write_recording(tmp_path / "rigid.rrd", compiled, film, magnification=0.0)
    columns = columns_of(tmp_path / "rigid.rrd")
    for body in ("upper", "fore"):
        for part in ("Transform3D:translation", "Transform3D:quaternion"):
            assert columns[f"/robot/rigid/{body}"][part] == columns[f"/robot/elastic/{body}"][part]


def test_measured_point_lies_on_the_reflector_for_perfect_instruments(columns: Columns) -> None:
    drawn = [row for row in columns["/robot/elastic/reference_point"]["Points3D:positions"] if row]
    measured = [row for row in columns["/tracker/measured"]["Points3D:positions"] if row]
    np.testing.assert_allclose(measured, drawn[-len(measured) :], atol=SINGLE_PRECISION)


def test_missing_instruments_leave_no_empty_curves(compiled: CompiledRobot, film: Film, tmp_path: Path) -> None:
    path = tmp_path / "blind.rrd"
    write_recording(path, compiled, without(film, "current", "reflectors", "gas_pressure", "force"))
    verify(path)
    columns = columns_of(path)
    assert not [entity for entity in columns if entity.startswith(("/current", "/counterbalance/pressure"))]
    assert "/deflection/measured\\ x" not in columns
    assert "/force/measured\\ x" not in columns
    assert "/deflection/true\\ x" in columns


def test_the_same_film_is_the_same_recording(
    compiled: CompiledRobot, film: Film, recording: Path, tmp_path: Path
) -> None:
    def identity(path: Path) -> str:
        return RrdReader(path).recordings()[0].recording_id

    write_recording(tmp_path / "again.rrd", compiled, film)
    write_recording(tmp_path / "other.rrd", compiled, instants(film, slice(0, 50)))
    assert identity(tmp_path / "again.rrd") == identity(recording) != identity(tmp_path / "other.rrd")


def test_an_error_leaves_the_old_file_and_nothing_else(
    compiled: CompiledRobot, film: Film, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    path = tmp_path / "session.rrd"
    path.write_text("old")
    monkeypatch.setattr(bench.report.recording.write, "log_plots", fail)
    with pytest.raises(ZeroDivisionError):
        write_recording(path, compiled, film)
    assert [entry.name for entry in tmp_path.iterdir()] == ["session.rrd"]
    assert path.read_text() == "old"


def test_what_cannot_be_written_is_said(
    compiled: CompiledRobot, film: Film, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="no instant"):
        write_recording(tmp_path / "empty.rrd", compiled, instants(film, slice(0, 0)))
    with pytest.raises(InputError, match="cannot be written"):
        write_recording(tmp_path / "nowhere" / "session.rrd", compiled, film)
    monkeypatch.setenv("RERUN", "off")
    with pytest.raises(InputError, match="RERUN"):
        write_recording(tmp_path / "off.rrd", compiled, film)
    assert not list(tmp_path.iterdir())


def test_ten_minutes_of_the_real_robot_are_small(tmp_path: Path, rng: np.random.Generator) -> None:
    """The made-up film, looped with fresh noise, so that it compresses no better than a real one."""
    compiled = compile_robot(load_robot("hh150"))
    loops = TEN_MINUTES // LENGTH
    films = [made_film(compiled, rng) for _ in range(loops)]
    film = films[0]
    trace = type(film.trace).concatenate(part.trace for part in films)
    trace = type(trace)(**(vars(trace) | {"time": 0.1 * np.arange(len(trace))}))
    reading = type(film.reading)(
        **{name: np.concatenate([getattr(part.reading, name) for part in films]) for name in vars(film.reading)}
    )
    write_recording(tmp_path / "long.rrd", compiled, Film(trace, reading, ()))
    verify(tmp_path / "long.rrd")
    assert (tmp_path / "long.rrd").stat().st_size < LARGEST
