"""Open a recording in the Rerun viewer."""

import os
import subprocess
import sys
from pathlib import Path

from bench.errors import BenchError, InputError

RERUN = (sys.executable, "-m", "rerun")
ONLY_THIS_MACHINE = ("--bind", "127.0.0.1")  # the viewer listens for data; nobody else needs to send it any


def view(path: Path) -> None:
    """Open an .rrd file, or every one in a folder, in the viewer; return when the viewer is closed.

    Raises:
        InputError: There is no recording at `path`.
        BenchError: There is no display, or the viewer ended with an error.
    """
    recordings = [str(recording) for recording in recordings_in(path)]
    if not has_display():
        raise InputError(
            "there is no display for the viewer. Open the recording in a browser instead: run `rerun "
            f"--web-viewer --bind 127.0.0.1 {' '.join(recordings)}` and go to the address that it prints; or copy "
            "the file to a computer with a screen and run `rerun FILE` there (`pip install rerun-sdk`)."
        )
    code = subprocess.run([*RERUN, *ONLY_THIS_MACHINE, *recordings], check=False).returncode
    if code != 0:
        raise BenchError(f"the Rerun viewer ended with code {code}; its own message stands above.")


def recordings_in(path: Path) -> tuple[Path, ...]:
    """Return the recordings at `path`: the file itself, or the .rrd files of a folder, sorted by name.

    Raises:
        InputError: There is none.
    """
    if not path.exists():
        raise InputError(
            f"{path}: does not exist; give a folder that `bench run` or `bench diagnose` wrote, or an .rrd file."
        )
    if path.is_file():
        if path.suffix != ".rrd":
            raise InputError(f"{path}: is not a recording; give an .rrd file, or the folder that holds one.")
        return (path,)
    found = tuple(sorted(path.glob("*.rrd")))
    if not found:
        inside = [str(folder) for folder in _folders_with_recordings(path)]
        remedy = f"give one of {', '.join(inside)}" if inside else "`bench run` and `bench diagnose` write one"
        raise InputError(f"{path}: holds no recording (*.rrd); {remedy}.")
    return found


def _folders_with_recordings(path: Path) -> list[Path]:
    """Return the folders one or two levels below `path` that hold recordings, as `bench paper` writes them."""
    return sorted({recording.parent for pattern in ("*/*.rrd", "*/*/*.rrd") for recording in path.glob(pattern)})


def has_display() -> bool:
    """Return whether a window can be opened; only Linux without an X or Wayland server is known not to."""
    return not sys.platform.startswith("linux") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
