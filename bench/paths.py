"""Where the robots and the scenarios that come with the package lie on disk.

A wheel carries the top-level folders `models/` and `scenarios/` inside the package; an editable installation uses those
of the repository, so that an edit there counts at once.
"""

from pathlib import Path

_PACKAGE = Path(__file__).parent
_INSTALLED = _PACKAGE / "_data"
_ROOT = _INSTALLED if _INSTALLED.is_dir() else _PACKAGE.parent


def models_dir() -> Path:
    """Return the folder with one folder per robot."""
    return _ROOT / "models"


def scenarios_dir() -> Path:
    """Return the folder with the scenario files."""
    return _ROOT / "scenarios"
