"""What a command is started in: no output to print to, a terminal of no width, graphics that are none."""

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from bench.cli import main
from bench.cli.memory import short_of_memory
from bench.errors import InputError
from bench.report.files import replacing

BENCH = Path(sys.executable).with_name("bench")


def ended(command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["sh", "-c", command],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_closed_output_is_told() -> None:
    found = ended(f"{BENCH} robots >&-")
    assert (found.returncode, "output is closed" in found.stderr) == (2, True)
    assert "Traceback" not in found.stderr


def test_what_is_said_may_go_nowhere() -> None:
    found = ended(f"{BENCH} check /no/such/folder 2>&-")
    assert found.returncode == 3
    assert "there is no folder" in found.stdout


@pytest.mark.parametrize("columns", ["1", "2", "4", "5"])
def test_help_in_a_terminal_of_no_width(columns: str) -> None:
    found = ended(f"{BENCH} check --help", COLUMNS=columns)
    assert (found.returncode, "usage" in found.stdout) == (0, True)


def test_graphics_that_are_none(tmp_path: Path) -> None:
    (tmp_path / "campaign.yaml").write_text("robot: hh150\nruns: []\n")
    found = ended(f"{BENCH} diagnose {tmp_path} -o {tmp_path / 'out'}", MUJOCO_GL="foo")
    assert (found.returncode, "MUJOCO_GL: foo; egl" in found.stderr) == (2, True)
    assert "Traceback" not in found.stderr


def test_pictures_for_a_screen_that_is_none() -> None:
    """A backend that matplotlib does not know ended a diagnosis in a traceback, once all was computed."""
    draw = "from bench.cli import main; main(['robots']); from bench.report.figures.style import small_figure as draw; "
    found = ended(f'{sys.executable} -c "{draw}draw(1, 1, 2.0, 2.0)"', MPLBACKEND="nothing")
    assert (found.returncode, found.stderr) == (0, "")


@pytest.mark.parametrize(
    "arguments", ["check ''", "apply '' -o out", "predict emps ''", "diagnose . --given '' -o out"]
)
def test_an_argument_that_is_empty_is_no_folder(arguments: str) -> None:
    """What a variable of the shell that is not set leaves was taken for the folder here."""
    found = ended(f"{BENCH} {arguments}")
    assert (found.returncode, "an empty argument" in found.stderr) == (2, True)


@pytest.mark.parametrize("output", [">/dev/full 2>/dev/full", "1</dev/null"])
def test_output_that_takes_nothing_is_told_by_the_exit_code(output: str) -> None:
    """A full disk for both outputs was called an error of the bench, one open for reading alone a traceback."""
    found = ended(f"{BENCH} robots {output}")
    assert (found.returncode, "Traceback" in found.stderr) == (2, False)


def test_output_that_may_not_grow_is_one_sentence(tmp_path: Path) -> None:
    """A limit of the size of files (`ulimit -f`, a FAT disk) ended in a traceback, where a full disk did not."""
    found = ended(f"sh -c 'ulimit -f 1; exec {BENCH} effects > {tmp_path / 'out'}'")
    assert (found.returncode, "what it prints cannot be written" in found.stderr) == (2, True)
    assert "Traceback" not in found.stderr


def test_a_file_that_may_not_grow_is_named(tmp_path: Path) -> None:
    """A full disk for the file of -o was called one for what is printed."""
    with pytest.raises(InputError, match="cannot be written"), replacing(tmp_path / "a.yaml"):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert not list(tmp_path.iterdir())


def test_a_full_folder_for_temporary_files_is_one_sentence(tmp_path: Path) -> None:
    """It ended in a traceback."""
    (tmp_path / "log.csv").write_text("t,q\n" + "".join(f"{k / 100},{k % 7}\n" for k in range(200)))
    found = ended(f"sh -c 'ulimit -f 0; exec {BENCH} convert --look {tmp_path}/log.csv -o {tmp_path}/look.yaml'")
    assert (found.returncode, "No usable temporary directory" in found.stderr, "TMPDIR" in found.stderr) == (
        2,
        True,
        True,
    )
    assert "Traceback" not in found.stderr


@pytest.mark.parametrize(
    "command",
    [
        "apply hh150 -o {out} --motion {shut}/motion.csv",
        "run {shut}/scenario.yaml -o {out}",
        "new-robot mine --mjcf {shut}/arm.xml -o {out}",
        "diagnose . -o {out} --file {shut}/effects.py",
        "view {shut}/session.rrd",
        "convert hh150 {shut} -o {out} --log {shut}/log.yaml",
    ],
)
def test_a_folder_that_may_not_be_searched_is_one_sentence(command: str, tmp_path: Path) -> None:
    """A file in another user's folder ended in a traceback; to root every folder is open."""
    shut, out = tmp_path / "shut", tmp_path / "out"
    shut.mkdir(mode=0o000)
    drop = ""
    if os.geteuid() == 0:
        if not shutil.which("setpriv"):
            pytest.skip("root may search every folder, and setpriv is not there to take that from it")
        drop = "setpriv --bounding-set=-dac_override,-dac_read_search "
    found = ended(f"{drop}{BENCH} {command.format(shut=shut, out=out)}")
    shut.chmod(0o700)
    assert (found.returncode, "Permission denied" in found.stderr, str(shut) in found.stderr) == (2, True, True)
    assert "Traceback" not in found.stderr


UNMAPPED = "librerun.so: failed to map segment from shared object"


@pytest.mark.parametrize(
    ("error", "code", "told"),
    [
        (ImportError(UNMAPPED, name="rerun_bindings"), 2, f"too little memory ({UNMAPPED}); give it more (ulimit -v"),
        (ModuleNotFoundError("No module named 'rerun'", name="rerun"), 6, "install the bench again"),
        (OSError(24, "Too many open files", "x.so"), 2, "Too many open files; let it open more (ulimit -n)"),
        (RuntimeError("Could not allocate memory"), 2, "too little memory (Could not allocate memory)"),  # of MuJoCo
        (MemoryError("Unable to allocate 5. GiB"), 2, "too little memory (Unable to allocate 5. GiB); give it more"),
    ],
)
def test_memory_that_is_too_little_is_one_sentence(
    error: Exception, code: int, told: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`ulimit -v` ended in the traceback of an ImportError."""

    def fails(_: object) -> int:
        raise error

    monkeypatch.setattr("bench.cli.robots.Robots.run", fails)
    assert main(["robots"]) == code
    assert told in capsys.readouterr().err


def test_a_module_of_the_bench_that_is_not_there_is_an_error_of_the_bench(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_: object) -> int:
        raise ImportError("cannot import name 'x' from 'bench.robot'", name="bench.robot")

    monkeypatch.setattr("bench.cli.robots.Robots.run", fails)
    with pytest.raises(ImportError):
        main(["robots"])


def test_a_limit_on_memory_is_what_the_engine_fails_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo's bindings say "unknown exception" of memory that they do not get: a traceback under `ulimit -v`."""
    unknown = RuntimeError("Caught an unknown exception!")
    assert not short_of_memory(unknown)
    monkeypatch.setattr("resource.getrlimit", lambda which: (2**31, 2**31))
    assert "give it more" in short_of_memory(unknown)
    assert not short_of_memory(RuntimeError("anything else"))
