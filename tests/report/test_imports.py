"""The report loads what it draws with only when it draws."""

import pkgutil
import subprocess
import sys

import bench.report

HEAVY = ("rerun", "matplotlib", "rich", "jinja2")


def test_importing_the_report_loads_no_drawing_library() -> None:
    modules = [module.name for module in pkgutil.walk_packages(bench.report.__path__, "bench.report.")]
    probe = f"import sys, importlib; [importlib.import_module(m) for m in {modules!r}]; print(*sys.modules, sep='\\n')"
    loaded = subprocess.run([sys.executable, "-c", probe], check=True, capture_output=True, text=True).stdout.split()
    assert not set(HEAVY) & set(loaded)
