"""Scenarios, log formats, logs, other people's models, and places to write to."""

import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from bench import paths
from tests.poison.in_robots import LAUGHS
from tests.poison.variant import Spoil, Variant

SCENARIO = "mine.yaml"
RUN = ("run", SCENARIO, "-o", "../out")  # no truth goes into a campaign
CONVERT = ("convert", "robot", "log.csv", "-o", "out")
LOG = "kind: motion\ncolumns:\n  time_s: {from: t}\n  q_cmd_1_rad: {from: q}\n  q_motor_1_rad: {from: m}\n"
LOG += "  q_cmd_2_rad: {from: s}\n"
ROWS = "t,q,m,s\n0,0.1,0.1,0\n0.1,0.2,0.2,0\n0.2,0.3,0.3,0\n"


def _file(name: str, text: str | bytes) -> Spoil:
    data = text if isinstance(text, bytes) else text.encode()

    def spoil(folder: Path) -> None:
        (folder / name).write_bytes(data)

    return spoil


def scenarios(rng: np.random.Generator) -> Iterator[Variant]:
    sound = (paths.scenarios_dir() / "loading.yaml").read_text()
    faults: dict[str, tuple[str | bytes, str]] = {
        "a key given twice": (sound + "seed: 7\n", "twice"),
        "an unknown key": (sound + "sed: 7\n", "sed"),
        "a thousand million laughs": (sound + LAUGHS, "BENCH_MOST_YAML_VALUES"),
        "brackets": (sound + f"x: {'[' * 50_000}", "BENCH_MOST_YAML_DEPTH"),
        "another experiment": ("experiment: drive\n", "experiment"),
        "an experiment that is a list": ("experiment: [loading]\n", "experiment"),
        "repeats of nan": (sound.replace("repeats: 10", "repeats: .nan"), "repeats"),
        "repeats of 1e18": (sound.replace("repeats: 10", "repeats: 1000000000000000000"), "repeats"),
        "angles of inf": (sound.replace("[0.1, 27.9,", "[.inf, 27.9,"), "poses[0].q_deg"),
        "a word for a force": (sound.replace("[467, 641,", "[much, 641,"), "poses[0].force_n"),
        "a robot that is not there": (sound.replace("robot: hh150", "robot: hh151"), f"{SCENARIO}: robot"),
        "angles outside of the joint": (sound.replace("[0.1, 27.9,", "[0.1, 927.9,"), f"{SCENARIO}: poses[0].q_deg[1]"),
        "an angle too few": (sound.replace("[0.1, 27.9,", "[27.9,"), f"{SCENARIO}: poses[0].q_deg"),
        "a list": ("- 1\n", SCENARIO),
        "nothing": ("", SCENARIO),
        "random bytes": (rng.bytes(500), SCENARIO),
        "latin-1": ("experiment: größer".encode("latin-1"), "UTF-8"),
        "a long number": (sound.replace("seed: 1", f"seed: {'9' * 5000}"), "characters"),
        "a date that is none": (sound + "x: 2024-99-99\n", "month"),
    }
    line = (paths.scenarios_dir() / "line.yaml").read_text()
    faults["a line without speed"] = (
        re.sub(r"speed_m_per_s: [\d.]+", "speed_m_per_s: 1e-320", line, count=1),
        "speed_m_per_s: 0.6 m and 3 s at both ends take more than 10 000 seconds",  # it ended in a traceback
    )
    for name, (text, place) in faults.items():
        yield Variant("scenarios", name, _file(SCENARIO, text), "error", (place,), RUN)


def log_formats(rng: np.random.Generator) -> Iterator[Variant]:
    faults: dict[str, tuple[str, str]] = {
        "a key given twice": (LOG + "kind: static\n", "twice"),
        "a column given twice": (LOG + "  time_s: {from: t}\n", "twice"),
        "an unknown column": (LOG + "  angle: {from: q}\n", "angle"),
        "a foreign unit": (LOG + "  q_link_1_deg: {from: q}\n", "q_link_1_rad"),
        "a factor of nan": (LOG.replace("{from: q}", "{from: q, factor: .nan}"), "q_cmd_1_rad.factor"),
        "a factor of inf": (LOG.replace("{from: q}", "{from: q, factor: 1e999}"), "q_cmd_1_rad.factor"),
        "a factor of 0": (LOG.replace("{from: q}", "{from: q, factor: 0}"), "q_cmd_1_rad.factor"),
        "a factor of 0 of a clock": (LOG.replace("{from: t}", "{from: t, factor: -0.0}"), "time_s.factor"),
        "a word for a factor": (LOG.replace("{from: q}", "{from: q, factor: pi}"), "q_cmd_1_rad.factor"),
        "no source": (LOG.replace("{from: q}", "{factor: 1}"), "q_cmd_1_rad"),
        "no columns": ("kind: motion\n", "columns"),
        "a source that is not there": (LOG.replace("from: q}", "from: angle}"), "angle"),
        "laughs": (LAUGHS, "BENCH_MOST_YAML_VALUES"),
        "brackets": (f"columns: {'[' * 50_000}", "BENCH_MOST_YAML_DEPTH"),
        "nothing": ("", "log.yaml"),
        "a factor that overflows": (LOG.replace("{from: q}", "{from: q, factor: 1e308}"), "q"),
    }
    for name, (text, place) in faults.items():

        def spoil(folder: Path, text: str = text) -> None:
            (folder / "robot" / "log.yaml").write_text(text)
            (folder / "log.csv").write_text(ROWS)

        yield Variant("log formats", name, spoil, "error", (place,), CONVERT)


def logs(rng: np.random.Generator) -> Iterator[Variant]:
    made: dict[str, tuple[Callable[[Path], object], str]] = {
        "a pipe": (os.mkfifo, "log.csv"),
        "a folder without logs": (Path.mkdir, "log.csv"),
        "an endless device": (lambda file: file.symlink_to("/dev/zero"), "log.csv"),
        "a loop of links": (lambda file: file.symlink_to("log.csv"), "log.csv"),
        "nothing": (lambda file: None, "log.csv"),
        "no rows": (lambda file: file.write_text("t,q,m,s\n"), "log.csv"),
        "an empty file": (lambda file: file.write_text(""), "log.csv"),
        "zeros": (lambda file: file.write_bytes(bytes(500)), "log.csv"),
        "a word": (lambda file: file.write_text(ROWS.replace("0.2,0.2,", "two,0.2,")), "row 2"),
        "a missing value": (lambda file: file.write_text(ROWS.replace("0.2,0.2,", ",0.2,")), "row 2"),
        "time that runs back": (lambda file: file.write_text(ROWS + "0.1,1,1,0\n"), "row 4"),
        "a column given twice": (lambda file: file.write_text(ROWS.replace("t,q,m", "t,q,q")), "q"),
    }
    for name, (make, place) in made.items():

        def spoil(folder: Path, make: Callable[[Path], object] = make) -> None:
            (folder / "robot" / "log.yaml").write_text(LOG)
            make(folder / "log.csv")

        yield Variant("logs", name, spoil, "error", (place,), CONVERT)


def clocks_of_dead_batteries(rng: np.random.Generator) -> Iterator[Variant]:
    """Begin the dates of a log where controllers without a battery do; before 1970 time ran backwards."""
    for begin in (
        "1970-01-01T00:30:00{}+01:00",
        "1970-01-01T00:00:00{}",
        "1904-01-01 00:00:00{}",
        "1900-01-01T12:00:00{}",
    ):

        def spoil(folder: Path, begin: str = begin) -> None:
            (folder / "robot" / "log.yaml").write_text(LOG)
            rows = ROWS
            for second in ("0.1", "0.2", "0"):
                rows = rows.replace(f"\n{second},", f"\n{begin.format(second[1:])},")
            (folder / "log.csv").write_text(rows)

        yield Variant("clocks of dead batteries", begin.format(""), spoil, "harmless", (), CONVERT)


def logs_that_ask_too_much(rng: np.random.Generator) -> Iterator[Variant]:
    beside = "tables:\n  f: {{file: {}, time_s: {{from: t}}}}\n"
    force = LOG + "  force_z_n: {from: z, table: f}\n"
    long = "t,q,m,s\n" + "".join(f"{i / 100},{i / 1000},{i / 1000},0\n" for i in range(200))
    faults: dict[str, tuple[str, str]] = {
        "1e9 rows a second": (LOG + "resample: {rate_hz: 1.0e9}\n", "rate_hz"),
        "1e6 rows a second and a day": (LOG.replace("from: t", "from: t, factor: 40000"), ""),
        "a row in 100 seconds": (LOG + "resample: {rate_hz: 0.01}\n", "leave one row"),
        "a low-pass of years": (LOG + "resample: {rate_hz: 50, cutoff_hz: 1.0e-9}\n", "give a cutoff_hz"),
        "a file of the system": (force + beside.format("../../../etc/passwd"), "without folders"),
        "a folder as a file": (force + beside.format("'..'"), "without folders"),
        "a name too long": (force + beside.format("x" * 5000), "cannot be read"),
        "1e9 lines to skip": (LOG + "table: {skip_lines: 1000000000}\n", "has 202 lines"),
        "a drive that is not there": (LOG + "  tau_motor_9_nm: {from: m}\n", "the robot has 2 drives"),
        "a drive without an angle": (LOG.replace("  q_cmd_2_rad: {from: s}\n", ""), "no angle of drive 2"),
        "1e300 rows a second": (LOG.replace("{from: t}", "{rate_hz: 1.0e300}"), "give it in seconds"),
        "6000 windows over each other": (LOG + f"runs: {{windows_s: {[[0, 2]] * 6000}}}\n", "and 5998 more"),
    }
    faults["1e6 rows a second and a day"] = (
        faults["1e6 rows a second and a day"][0] + "resample: {rate_hz: 1.0e6}\n",
        "more than 20 000 000 cells",
    )
    for name, (text, place) in faults.items():

        def spoil(folder: Path, text: str = text) -> None:
            (folder / "robot" / "log.yaml").write_text(text)
            (folder / "log.csv").write_text(long)

        yield Variant("logs that ask too much", name, spoil, "error", (place,), CONVERT)
    for name, file in (("a pipe", os.mkfifo), ("a device", lambda path: path.symlink_to("/dev/zero"))):

        def in_place(folder: Path, file: Callable[[Path], object] = file) -> None:
            (folder / "robot" / "log.yaml").write_text(LOG)
            file(folder / "log.csv")

        place = "is a named pipe" if name == "a pipe" else "is a device"
        yield Variant("logs that ask too much", f"{name} as a log", in_place, "error", (place,), CONVERT)


def logs_to_look_at(rng: np.random.Generator) -> Iterator[Variant]:
    """Give `bench convert --look` logs that are too short or too odd to tell anything."""
    command = ("convert", "--look", "log.csv", "--robot", "robot")

    def rows(count: int) -> str:
        return "t,q1,q2,i1,i2\n" + "".join(f"{i / 100},{i / 100},0.1,{i % 3},{i % 5}\n" for i in range(count))

    for count in (3, 5, 12, 40):
        yield Variant("logs to look at", f"{count} rows", _file("log.csv", rows(count)), "harmless", (), command)
    huge = rows(40).replace("\n0.0", "\n1e3000")
    yield Variant("logs to look at", "clock cells beyond all numbers", _file("log.csv", huge), "harmless", (), command)
    tiny = "t,q1,q2,i1,i2\n" + "".join(
        f"{i / 100},{np.sin(i / 30)},{np.cos(i / 50)},{np.cos(i / 30)}e-300,{np.sin(i / 20)}\n" for i in range(400)
    )
    words = ("current_1_a", "stands still")
    yield Variant("logs to look at", "a current of 1e-300", _file("log.csv", tiny), "harmless", words, command)


def models_of_others(rng: np.random.Generator) -> Iterator[Variant]:
    """Give `bench new-robot` what is no model."""
    world = "<mujoco><worldbody>{}</worldbody></mujoco>"
    body = '<body><joint name="a"/><geom size="1"/></body>'
    faults: dict[str, tuple[str | bytes, str]] = {
        "5000 bodies in each other": (world.format("<body>" * 5000 + "</body>" * 5000), "line"),
        "entities": ("<!DOCTYPE a [<!ENTITY b 'c'>]><mujoco/>", "line 1"),
        "10^10 copies": (world.format(f"<replicate count='10000000000'>{body}</replicate>"), "line 1"),
        "a nan": (world.format(body.replace("size", "pos='nan 0 0' size")), "nan"),
        "no joints": ("<mujoco/>", "no joints"),
        "a URDF without links": ("<robot name='r'/>", "arm.xml"),
        "a URDF whose links form a ring": (
            "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent link='a'/>"
            "<child link='b'/></joint><joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint></robot>",
            "arm.xml",
        ),
        "another language": ("<svg/>", "arm.xml"),
        "nothing": ("", "arm.xml"),
        "random bytes": (rng.bytes(2000), "arm.xml"),
    }  # fmt: skip
    urdf = (
        "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='5'/><origin xyz='0 0 0.3'/><inertia "
        "ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j' type='revolute'>"
        "<parent link='a'/><child link='b'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='100' velocity='2'/>"
        "</joint></robot>"
    )
    for old, new, place in (
        ("mass value='5'", "mass value='5000000'", "mass is 5e+06 kg"),
        ("mass value='5'", "mass value='-5'", "positive mass"),
        ("xyz='0 1 0'", "xyz='0 0 0'", "axis"),
        ("lower='-1'", "lower='1'", "lower and upper are both 1"),
        ("lower='-1'", "lower='2'", "exchange them"),
        ("upper='1'", "upper='180'", "range is 180 rad"),
        ("effort='100'", "effort='-100'", "effort is -100"),
        ("velocity='2'", "velocity='1e9'", "speed_limit_rad_per_s"),
    ):
        faults[f"a URDF with {new}"] = (urdf.replace(old, new), place)
    loose = "<link name='c'/>"
    faults["a URDF with a link on no joint"] = (urdf.replace("</robot>", f"{loose}</robot>"), "'a' and 'c' hang on no")
    faults["a URDF with its base lost"] = (urdf.replace("parent link='a'", "parent link='d'"), "arm.xml")
    command = ("new-robot", "mine", "--mjcf", "arm.xml", "-o", "out")
    for name, (text, place) in faults.items():
        yield Variant("models of others", name, _file("arm.xml", text), "error", (place,), command)
    emoji = urdf.replace("name='j'", "name='\N{ROBOT FACE}'")
    yield Variant("models of others", "an emoji for a joint", _file("arm.xml", emoji), "harmless", (), command)


def places_to_write_to(rng: np.random.Generator) -> Iterator[Variant]:
    def sound(folder: Path) -> None:
        (folder / "robot" / "log.yaml").write_text(LOG)
        (folder / "log.csv").write_text(ROWS)
        (folder / "loop").symlink_to("loop")
        os.mkfifo(folder / "pipe")

    for out in (
        "log.csv",
        "log.csv/sub",
        "log.csv/sub/sub",
        "loop",
        "loop/sub",
        "runs",
        "pipe",
        "/dev/null/x",
        "x" * 300,
    ):
        yield Variant("places to write to", out[:20], sound, "error", (), (*CONVERT[:-1], out))
    for out in ("größe", "a b", "new/folder", "-x"):
        command = (*CONVERT[:-2], f"--out={out}")
        yield Variant("places to write to", out, sound, "harmless", (), command)


FAMILIES = (
    *(scenarios, log_formats, logs, clocks_of_dead_batteries, logs_that_ask_too_much, logs_to_look_at),
    *(models_of_others, places_to_write_to),
)
