"""The data folders are found in a wheel, in an editable installation and in the repository."""

import shutil
import subprocess
import sys
from pathlib import Path

from bench import paths


def test_folders_of_this_installation_have_content():
    assert any(paths.models_dir().glob("*/*.xml"))
    assert any(paths.scenarios_dir().glob("*.yaml"))


def test_wheel_uses_what_it_carries(tmp_path: Path):
    """A folder models/ of someone else in site-packages does not count. -S hides the editable installation, if any."""
    package = tmp_path / "bench"
    (package / "_data").mkdir(parents=True)
    (tmp_path / "models").mkdir()
    shutil.copy(paths.__file__, package)
    (package / "__init__.py").touch()
    code = "from bench.paths import models_dir, scenarios_dir; print(models_dir(), scenarios_dir(), sep='\\n')"
    run = subprocess.run([sys.executable, "-S", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stdout.split() == [str(package / "_data" / "models"), str(package / "_data" / "scenarios")]
