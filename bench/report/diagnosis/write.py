"""The files of a diagnosis: the verdict as JSON, words, page and recording, and the robot as fitted."""

import json
import shutil
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from bench.diagnose.cross_validation.figures import fitted_figures
from bench.diagnose.cross_validation.posterior import posterior_of
from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.extend.fit import Fit
from bench.diagnose.name.learned_shape import learned_of
from bench.diagnose.verdict import Verdict
from bench.errors import NoLibraryError, RobotError
from bench.predict.promises import write_promises
from bench.record.campaign import Campaign
from bench.report.diagnosis.facts import facts_of, facts_without
from bench.report.diagnosis.file_names import (
    DIFFERENCE,
    FIGURES,
    NOMINAL_MJCF,
    RECORDING,
    REPORT,
    ROBOT,
    TEXT,
    VERDICT,
    WORDS,
)
from bench.report.diagnosis.page import Pictures, page_of
from bench.report.diagnosis.pictures import learned_picture, pictures_of
from bench.report.diagnosis.readings import readings_of
from bench.report.diagnosis.recording import write_diagnosis_recording
from bench.report.diagnosis.words import brief_words, words_of
from bench.report.handover.figures_table import csv_of, moved_sentences
from bench.report.handover.posterior_file import write_posterior
from bench.report.handover.robot_folder import README, Handed, hand_over
from bench.report.jsonable import to_jsonable

NOT_DONE = """
**Its diagnosis ended before it was done.** What was not looked for yet may sit in the wrong figures: hold it against
plain least squares (`bench identify --method dynamics`) before it is used. It promises nothing of a recording.
"""


def write_diagnosis(
    diagnosis: Diagnosis, folder: Path, campaign: Campaign | None = None, command: str = ""
) -> tuple[str, ...]:
    """Write the files of a diagnosis into an existing folder.

    The robot as fitted is handed over whatever was found: figures may have moved where nothing else was wrong.

    Args:
        diagnosis: What to write.
        folder: Where to.
        campaign: That was diagnosed; the report then has its notes and counts its rows.
        command: That made the diagnosis, for the report.

    Returns:
        What to print of it: the verdict in short, and a sentence where there is no recording because Rerun's library
        cannot be loaded.

    Raises:
        InputError: The recording cannot be written.
        RobotError: The scene that the robot's figures name does not compile, or a mesh of the robot is gone.
    """
    readings = readings_of(diagnosis)
    facts = facts_of(diagnosis, readings, campaign, command)
    fit = diagnosis.extension or diagnosis.naming.null
    handed = _handed(diagnosis, fit, folder)
    figures = fitted_figures(diagnosis.linear, fit)
    moved = tuple(moved_sentences(figures))
    _write(folder / FIGURES, csv_of(figures))
    handed_over = {"disagreement": handed.disagreement, "missing": handed.missing}
    content = diagnosis.verdict.as_json() | facts.as_json()
    content |= {"figures": [asdict(figure) for figure in figures], "handed_over": handed_over}
    _write(folder / VERDICT, json.dumps(to_jsonable(content), indent=2) + "\n")
    sentences = _say(diagnosis.verdict, folder, moved)
    try:
        write_diagnosis_recording(folder / RECORDING, diagnosis, readings)
    except NoLibraryError as error:  # all else that took minutes is worth having without it
        sentences = (*sentences, str(error))
    learned = learned_of(diagnosis.naming, diagnosis.discrepancy)
    pictures = Pictures(
        worst=pictures_of(readings),
        learned=tuple(learned_picture(curve, learned.block.kind) for curve in facts.learned) if learned else (),
        turns_round=learned is not None and learned.turns_round,
    )
    made = {name: words for name, words in WORDS.items() if (folder / name).exists()}
    _write(folder / REPORT, page_of(diagnosis.verdict, facts, pictures, made, handed.difference, moved))
    return sentences


def _say(verdict: Verdict, folder: Path, moved: Sequence[str] = ()) -> tuple[str, ...]:
    """Write all that a verdict says, and return what to print of it."""
    _write(folder / TEXT, "\n".join(words_of(verdict, moved)) + "\n")
    return tuple(brief_words(verdict, moved))


def _handed(diagnosis: Diagnosis, fit: Fit, folder: Path) -> Handed:
    """Write the robot as fitted; where what was fitted is no robot, say so, for the verdict is worth having alone."""
    unfinished = diagnosis.verdict.unfinished
    try:
        handed = hand_over(
            diagnosis.linear, fit, folder / ROBOT, folder / NOMINAL_MJCF, unfinished.why if unfinished else ""
        )
    except RobotError as error:
        shutil.rmtree(folder / ROBOT, ignore_errors=True)
        (folder / NOMINAL_MJCF).unlink(missing_ok=True)  # there for the difference alone
        return Handed("", (f"everything: what was fitted is no robot: {error}",), float("nan"))
    if unfinished:
        with (folder / ROBOT / README).open("a", encoding="utf-8") as file:
            file.write(NOT_DONE)
    write_posterior(folder / ROBOT, posterior_of(diagnosis.linear, fit))
    write_promises(folder / ROBOT, diagnosis.verdict.predicted)
    _write(folder / DIFFERENCE, handed.difference)
    return handed


def write_unweighed(
    verdict: Verdict, folder: Path, campaign: Campaign, robot: str, command: str = ""
) -> tuple[str, ...]:
    """Write verdict and report of a diagnosis that ended before anything was weighed, into an existing folder.

    Args:
        verdict: That says so.
        folder: Where to.
        campaign: That was to be diagnosed.
        robot: Title of its robot.
        command: That was to do it, for the report.

    Returns:
        What to print of it.
    """
    facts = facts_without(campaign, robot, command)
    _write(folder / VERDICT, json.dumps(to_jsonable(verdict.as_json() | facts.as_json()), indent=2) + "\n")
    sentences = _say(verdict, folder)
    made = {name: WORDS[name] for name in (VERDICT, TEXT)}
    _write(folder / REPORT, page_of(verdict, facts, Pictures(()), made, ""))
    return sentences


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
