"""The rotation experiment of section 5 from its scenarios to its figures."""

from pathlib import Path

from bench.executor.contract import Executor, Progress, in_order
from bench.report.paper.rotation.identification import identify_rotation
from bench.report.paper.rotation.results import RotationReport, write_rotation
from bench.report.results import CAMPAIGN, TRUTH, run_and_forget
from bench.report.scoring import score_counterbalance
from bench.scenario.files import read_as
from bench.scenario.rotation import Rotation

SCENARIO, VALIDATION = "rotation", "rotation-validation"  # also the folders of their results


def run_rotation(folder: Path, progress: Progress, executor: Executor) -> RotationReport:
    """Run both scenarios, identify the counterbalance from the first, predict the second, and write what came out.

    Args:
        folder: Existing folder; gets one folder per scenario, `rotation.json`, and Figs. 11 to 13 as PNG.
        progress: Called with the share that is done.
        executor: Where to simulate.
    """
    jobs = [(read_as(Rotation, name), folder / name) for name in (SCENARIO, VALIDATION)]
    in_order(executor, run_and_forget, jobs, progress)
    identified = identify_rotation(folder / SCENARIO / CAMPAIGN, folder / VALIDATION / CAMPAIGN)
    report = RotationReport(identified, score_counterbalance(identified.fit, folder / SCENARIO / TRUTH))
    write_rotation(report, folder)
    return report
