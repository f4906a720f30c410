"""The rotation experiment of section 5 from its scenarios to its figures."""

from collections.abc import Callable
from pathlib import Path

from bench.report.results import CAMPAIGN, TRUTH, write_session
from bench.report.rotation_identification import identify_rotation
from bench.report.rotation_results import RotationReport, write_rotation
from bench.report.scoring import score_counterbalance
from bench.scenario.files import read_as
from bench.scenario.rotation import Rotation
from bench.simulate.session import run_session

Progress = Callable[[float], None]

SCENARIO, VALIDATION = "rotation", "rotation-validation"  # also the folders of their results


def run_rotation(folder: Path, progress: Progress = lambda share: None) -> RotationReport:
    """Run both scenarios, identify the counterbalance from the first, predict the second, and write what came out.

    Args:
        folder: Existing folder; gets one folder per scenario, `rotation.json`, and Figs. 11 to 13 as PNG.
        progress: Called with the share that is done.
    """
    for i, name in enumerate((SCENARIO, VALIDATION)):
        session = run_session(read_as(Rotation, name), lambda share, i=i: progress((i + share) / 2))  # type: ignore[misc]
        (folder / name).mkdir()
        write_session(session, folder / name)
    identified = identify_rotation(folder / SCENARIO / CAMPAIGN, folder / VALIDATION / CAMPAIGN)
    report = RotationReport(identified, score_counterbalance(identified.fit, folder / SCENARIO / TRUTH))
    write_rotation(report, folder)
    return report
