"""Torques along a motion, against closed forms; and motions that cannot be taken."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.world import World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting, Place
from bench.errors import InputError
from bench.report.handover.applied import applied_robot
from bench.report.handover.apply import beyond
from bench.report.handover.feed_forward import PARTS, feed_forward, read_motion
from bench.report.handover.motion_faults import gaps
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.elastic_arm import elastic
from tests.small_robot import FRICTION, LINK, MASS, ROTOR

G = 9.81
RAMP, SLOPE = np.linspace(0, 1, 400), np.full(400, 1 / (399 * 0.004))  # [rad], [rad/s]
GIVE = 5e-3  # of a torque: the link hangs lower than its motor by its weight over the stiffness, some 1e-3 rad


@pytest.fixture(scope="module")
def compiled(small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot))


def written(file: Path, columns: dict[str, np.ndarray]) -> Path:
    np.savetxt(file, np.column_stack([*columns.values()]), delimiter=",", header=",".join(columns), comments="")
    return file


def sweep(speed: float = 0.0, acceleration: float = 0.0, count: int = 400) -> dict[str, np.ndarray]:
    """Return joint 2 on a parabola through 0.1 rad, joint 1 upright."""
    time = np.arange(count) * 0.004
    return {
        "time_s": time,
        "q_cmd_1_rad": np.zeros(count),
        "q_cmd_2_rad": 0.1 + speed * time + acceleration / 2 * time**2,
    }


def test_the_weight_of_a_link_and_its_payload(small_robot: Path, compiled: CompiledRobot, tmp_path: Path) -> None:
    motion = read_motion(written(tmp_path / "m.csv", sweep()), compiled)
    for payload in (0.0, 4.0):
        table = feed_forward(applied_robot(load_robot(small_robot), payload), motion)
        weight = -G * np.cos(0.1) * (MASS[1] * LINK[1] / 2 + payload * LINK[1])  # about y, of what points forward
        np.testing.assert_allclose(table.parts["links"][:, 1], weight, rtol=1e-12)
        np.testing.assert_allclose(table.torque, sum(table.parts.values()), atol=1e-9)
        held = table.parts["friction"][:, 1]
        assert np.all(np.abs(held) <= FRICTION[1]), "the link hangs on its friction, too"
        np.testing.assert_allclose((table.torque - table.parts["friction"])[:, 1], weight, rtol=GIVE)


def test_a_soft_arm_takes_what_its_links_do(tmp_path: Path) -> None:
    """With links that accelerate as their motors do drives 1 and 2 were missed by 9.1 and 6.4 Nm."""
    folder = load_robot("kr300")
    run = elastic(compile_robot(folder), 10.0).columns
    given = {key.replace("motor", "cmd"): values for key, values in run.items() if not key.startswith("tau")}
    motion = read_motion(written(tmp_path / "m.csv", given), compile_robot(folder))
    expected = np.stack([run[f"tau_motor_{j + 1}_nm"] for j in range(6)], axis=1)
    missed = np.sqrt(np.mean((feed_forward(applied_robot(folder), motion).torque - expected)[20:-20] ** 2, axis=0))
    print("missed [Nm]:", missed.round(2))
    assert np.all(missed < 1.5)


def test_rows_that_are_missing_are_told() -> None:
    time = np.delete(np.arange(400) * 0.004, slice(100, 200))
    (words,) = gaps(time, time[:, None])
    assert words.startswith("time_s: 0.404 s pass before row 101, and 0.004 s from row to row else (1 such gap)")
    assert not list(gaps(time, 0 * time[:, None])), "a rest needs no rows"
    assert not list(gaps(np.cumsum(np.linspace(0.1, 1, 50)), np.arange(50.0)[:, None])), "steps of a planner's own"


def test_what_friction_and_rotor_take(small_robot: Path, compiled: CompiledRobot, tmp_path: Path) -> None:
    motion = read_motion(written(tmp_path / "m.csv", sweep(0.1, 0.5)), compiled)
    np.testing.assert_allclose(motion.acceleration[:, 1], 0.5, atol=1e-8)
    np.testing.assert_allclose(motion.velocity[:, 1], 0.1 + 0.5 * motion.time, atol=1e-8)
    table = feed_forward(applied_robot(load_robot(small_robot)), motion)
    np.testing.assert_allclose(table.parts["rotor"][:, 1], 0.5 * ROTOR[1], atol=1e-6)
    np.testing.assert_allclose(table.parts["friction"][50:, 1], 2 * FRICTION[1], rtol=1e-9)
    assert set(table.parts) == set(PARTS)
    np.testing.assert_allclose(table.parts["balance"][:, 1], 0)
    assert compiled.counterbalance
    theta = -table.parts["balance"][:, 0]  # upright, joint 1 is near the dead centre of its cylinder
    assert np.all(np.abs(theta) < 0.1 * compiled.counterbalance.force(0.0))
    assert np.all(np.abs(table.parts["rest"][50:]) < GIVE * np.abs(table.torque).max())


def test_derivatives_that_the_planner_knows_are_taken(compiled: CompiledRobot, tmp_path: Path) -> None:
    speeds, accelerations = 0.1 + 0.52 * np.arange(400) * 0.004, np.full(400, 0.52)  # 4 % beside those of the rows
    known = {"velocity_1": 0 * speeds, "velocity_2": speeds, "acceleration_1": 0 * speeds}
    columns = sweep(0.1, 0.5) | known | {"acceleration_2": accelerations}
    motion = read_motion(written(tmp_path / "m.csv", columns), compiled)
    np.testing.assert_allclose(motion.velocity[:, 1], speeds)
    np.testing.assert_allclose(motion.acceleration[:, 1], accelerations)


def test_motions_beyond_a_drive_are_told(small_robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """2 rad/s and 9000 Nm are all that a drive gives; rotor and link of joint 2 have 24 kg m^2 and some."""
    for name, columns, said in (("slow", sweep(0.1), ""), ("fast", sweep(2.1, count=100), "hinge_b: 2.1 rad/s at ")):
        file = str(written(tmp_path / f"{name}.csv", columns))
        assert main(["apply", str(small_robot), "-o", str(tmp_path / name), "--motion", file]) == 0
        errors = capsys.readouterr().err
        assert errors.startswith(f"warning  {said}") if said else errors == ""
    jerky = sweep(0.0, 500.0, count=3)
    applied = applied_robot(load_robot(small_robot))
    motion = read_motion(written(tmp_path / "m.csv", jerky), applied.compiled)
    *_, words = beyond(feed_forward(applied, motion), motion, applied)
    assert words.startswith("hinge_b: ")
    assert words.endswith("more than the 9000 Nm of its drive")


def test_what_the_drive_shows_has_its_errors(found: Path, tmp_path: Path) -> None:
    applied = applied_robot(load_robot(found / "robot"))
    readings = applied.compiled.robot.figures.fitted.readings
    table = feed_forward(applied, read_motion(written(tmp_path / "m.csv", sweep(0.1)), applied.compiled))
    for j, name in enumerate(applied.bodies.names):
        constant = applied.compiled.torque_constant[j]
        expected = table.torque[:, j] / constant + readings.current_offset_a.get(name, 0.0)
        np.testing.assert_allclose(table.shown[f"current_{j + 1}_a"], expected, rtol=1e-9)
    assert readings.current_offset_a


def test_errors_of_a_channel_come_in_the_order_of_a_replay(small_robot: Path, tmp_path: Path) -> None:
    """A channel that is scaled scales the offset of its sensor too; it was added to what had been scaled."""
    applied = applied_robot(load_robot(small_robot))
    motion = read_motion(written(tmp_path / "m.csv", sweep(0.1)), applied.compiled)
    offset = Nuisance("offset", "A", 1.0, on_reading=lambda x, seen: replace(seen, current=seen.current + x))
    scaled = Acting(catalogue()["channel_scale"], Place("channel", 0, "current_1_a"), {"scale": 0.5})
    off, plain = World({offset: 0.3}), feed_forward(applied, motion).shown["current_1_a"]
    alone = feed_forward(replace(applied, world=off), motion).shown["current_1_a"]
    both = feed_forward(replace(applied, world=replace(off, acting=(scaled,))), motion).shown["current_1_a"]
    assert np.any(alone != plain)
    np.testing.assert_allclose(both, 1.5 * alone, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"time_s": np.zeros(400)}, "time_s: has to grow"),
        ({"q_cmd_2_rad": np.full(400, 2.1)}, r"row 1: q_cmd_2_rad: 2.1 is outside of -2 to 2"),
        ({"q_cmd_2_rad": None}, "lacks q_cmd_2_rad; a measured motion is none"),
        ({"q_cmd_2_rad": None, "q_cmd_2_m": np.zeros(400)}, "it has q_cmd_2_m, but that joint is a hinge, in rad"),
        ({"time_s": None}, r"lacks time_s\."),
        ({"time_s": 1e9 * sweep()["time_s"], "q_cmd_1_rad": RAMP}, r"time_s: goes on by 4e\+06 s.*give it in seconds"),
        ({"time_s": 1e-9 * sweep()["time_s"]}, r"time_s: goes on by 4e-12 s.*give it in seconds"),
        ({"q_cmd_1_rad": RAMP, "velocity_1": 57.3 * SLOPE, "velocity_2": 0 * SLOPE}, "velocity_1: reaches .*degrees"),
        ({"velocity_1": np.full(400, np.nan), "velocity_2": 0 * SLOPE}, "velocity_1: is not a number|no value"),
        ({"velocity_1": np.zeros(400)}, "has velocity_1 but not all of velocity_1, velocity_2"),
    ],
)
def test_motions_that_cannot_be_taken(compiled: CompiledRobot, tmp_path: Path, change: dict, said: str) -> None:
    columns = {name: values for name, values in (sweep() | change).items() if values is not None}
    with pytest.raises(InputError, match=said):
        read_motion(written(tmp_path / "m.csv", columns), compiled)


@pytest.mark.parametrize("payload", ["-1", "nan", "inf", "1e9", "4000"])  # it is rated for 30.6 kg
def test_a_payload_that_no_robot_carries_is_refused(
    small_robot: Path, tmp_path: Path, payload: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["apply", str(small_robot), "-o", str(tmp_path / "out"), f"--payload-kg={payload}"]) == 2
    assert "--payload-kg" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_payload_above_the_rating_is_told(
    small_robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["apply", str(small_robot), "-o", str(tmp_path / "out"), "--payload-kg=40"]) == 0
    assert "40 kg are more than the 30.6 kg of the rating" in capsys.readouterr().err


def test_files_that_cannot_be_read(compiled: CompiledRobot, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        read_motion(tmp_path / "none.csv", compiled)
    (tmp_path / "m.csv").write_text("time_s;q_cmd_1_rad\n0;1\n")
    with pytest.raises(InputError, match="semicolons"):
        read_motion(tmp_path / "m.csv", compiled)
    short = written(tmp_path / "m.csv", {name: values[:2] for name, values in sweep().items()})
    with pytest.raises(InputError, match="has 2 rows; give at least 3"):
        read_motion(short, compiled)


def test_the_command_leaves_nothing_behind_where_it_fails(
    found: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "m.csv").write_text("time_s\n0\n")
    for words in (["--motion", str(tmp_path / "m.csv")], ["--payload-kg", "-1"]):
        assert main(["apply", str(found), "-o", str(tmp_path / "applied"), *words]) == 2
    assert main(["apply", "hh151", "-o", str(tmp_path / "applied")]) == 4
    assert [entry.name for entry in tmp_path.iterdir()] == ["m.csv"]
    assert main(["apply", str(found), "-o", str(tmp_path / "applied")]) == 0
    written = sorted(entry.name for entry in (tmp_path / "applied").iterdir())
    assert written == ["README.md", "drives.csv", "small.urdf"]
    capsys.readouterr()
