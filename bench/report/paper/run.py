"""The whole paper on the virtual robot, chapter by chapter, its published numbers beside ours."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.executor.contract import Executor, Progress
from bench.identify.table5 import read_table6
from bench.report.jsonable import to_jsonable
from bench.report.paper.chapter import Chapter, print_chapter
from bench.report.paper.complementary.run import run_complementary
from bench.report.paper.line.fig17 import fig17_sentences, left_over
from bench.report.paper.line.published import published_rows as line_rows
from bench.report.paper.line.results import line_as_json, line_conclusions, write_line
from bench.report.paper.line.run import run_line
from bench.report.paper.loading.results import LoadingResult, loading_chapter, print_loading, write_loading
from bench.report.paper.loading.worlds import run_worlds
from bench.report.paper.methods.in_time import run_in_time
from bench.report.paper.methods.survival import UnderProtocol
from bench.report.paper.methods.trust import run_trust
from bench.report.paper.rotation.results import as_json as rotation_as_json
from bench.report.paper.rotation.results import published_rows as rotation_rows
from bench.report.paper.rotation.run import run_rotation
from bench.robot.folder import load_robot
from bench.scenario.complementary import Complementary
from bench.scenario.files import read_as
from bench.scenario.loading import Loading

RESULTS = "results.json"
PUBLISHED = "paper"  # folder of published data in the robot's folder
LOADING = "loading"
BOUNDS = "Where the paper speaks in words or of a bound, its column is that bound."
# Share of the time that each part takes, measured on two cores
LOADING_SHARE, TABLE_5_SHARE, COMPLEMENTARY_SHARE, TRUST_SHARE, ROTATION_SHARE = 0.38, 0.10, 0.05, 0.12, 0.15


@dataclass(frozen=True)
class PaperResult:
    """What `bench paper` found.

    Attributes:
        loading: Table 5 and the loading experiment, the main table.
        chapters: Everything else, in the order of the paper.
    """

    loading: LoadingResult
    chapters: tuple[Chapter, ...]


def run_paper(folder: Path, progress: Progress, executor: Executor, in_time: bool = False) -> PaperResult:
    """Run every experiment of the paper; campaigns, truth, recordings, numbers and figures go into an existing folder.

    Args:
        folder: Where to write.
        progress: Called with the share that is done.
        executor: Where to simulate.
        in_time: Whether protocols are also run in time.
    """
    scenario = read_as(Loading, LOADING)
    robot = load_robot(scenario.robot)
    table6 = read_table6(robot.folder / PUBLISHED)
    done = 0.0

    def part(share: float) -> Progress:
        nonlocal done
        begin = done
        done += share
        return lambda inside: progress(begin + share * inside)

    worlds = run_worlds(LOADING, _made(folder, "loading"), part(LOADING_SHARE), executor)
    loading = loading_chapter(worlds, robot.folder / PUBLISHED)
    write_loading(loading, folder / "loading")
    part(TABLE_5_SHARE)(1.0)
    names = next(iter(worlds[0].estimates.values())).joint_names
    complementary = run_complementary(read_as(Complementary, "complementary"), _made(folder, "complementary"))
    part(COMPLEMENTARY_SHARE)(1.0)
    trust, protocols = run_trust(scenario, names, table6, _made(folder, "methods"), part(TRUST_SHARE), executor)
    rotation = _rotation(_made(folder, "rotation"), part(ROTATION_SHARE), executor)
    line = _line(_made(folder, "line"), loading, protocols, part(1 - done), executor)
    further = (run_in_time(scenario, part(0.0), executor),) if in_time else ()
    result = PaperResult(loading, (complementary, rotation, line, trust, *further))
    content = {LOADING: loading.data} | {chapter.name: chapter.data for chapter in result.chapters}
    (folder / RESULTS).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return result


def print_paper(result: PaperResult) -> None:
    """Print the main table, and each chapter's numbers beside the paper's."""
    print_loading(result.loading)
    for chapter in result.chapters:
        print_chapter(chapter)


def _made(folder: Path, name: str) -> Path:
    made = folder / name
    made.mkdir()
    return made


def _rotation(folder: Path, progress: Progress, executor: Executor) -> Chapter:
    report = run_rotation(folder, progress, executor)
    covered = all(score.covered for score in report.scores)
    sentence = (
        "The virtual robot has the paper's C and l_c, so their rows show recovery, not a confirmation: the 95 % "
        f"intervals {'contain' if covered else 'do not both contain'} the truth."
    )
    return Chapter(
        name="rotation",
        title="Counterbalance, Table 7, Figs. 10 to 13",
        rows=rotation_rows(report.identified),
        sentences=(BOUNDS, sentence, *report.identified.fit.notes),
        data=rotation_as_json(report),
    )


def _line(
    folder: Path, loading: LoadingResult, protocols: Sequence[UnderProtocol], progress: Progress, executor: Executor
) -> Chapter:
    """Run the line with what the methods found from the loading experiment in the same world, the robot as it is."""
    report = run_line(folder, loading.as_model, progress, executor=executor)
    write_line(report, folder)
    here = {
        axis: report.reduction("force", axis).achieved / report.reduction("current", axis).achieved for axis in "xz"
    }
    left = left_over(report.scenario, [result for each in protocols for result in each.ideal])
    return Chapter(
        name="line",
        title="UV trajectory, Table 8, Figs. 14 to 17",
        rows=line_rows(report),
        sentences=(BOUNDS, *line_conclusions(report), *fig17_sentences(left, here)),
        data=line_as_json(report) | {"fig_17_by_friction_and_protocol": to_jsonable([asdict(each) for each in left])},
    )
