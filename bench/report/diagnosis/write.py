"""The files of a diagnosis: verdict.json, report.html, diagnosis.rrd, and the extended model with its difference."""

import difflib
import json
from pathlib import Path

from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.name.learned_shape import learned_of
from bench.diagnose.replay.world import World, edits_in
from bench.diagnose.verdict import Verdict
from bench.effects.effect import Conditions
from bench.record.campaign import Campaign
from bench.report.diagnosis.facts import facts_of, facts_without
from bench.report.diagnosis.file_names import DIFFERENCE, EXTENDED, RECORDING, REPORT, VERDICT, WORDS
from bench.report.diagnosis.page import Pictures, page_of
from bench.report.diagnosis.pictures import learned_picture, pictures_of
from bench.report.diagnosis.readings import readings_of
from bench.report.diagnosis.recording import write_diagnosis_recording
from bench.report.jsonable import to_jsonable
from bench.robot.compiled import read_spec


def write_diagnosis(diagnosis: Diagnosis, folder: Path, campaign: Campaign | None = None, command: str = "") -> None:
    """Write the files of a diagnosis into an existing folder.

    Effects of instruments do not stand in the model; with them alone there is no extended model.

    Args:
        diagnosis: What to write.
        folder: Where to.
        campaign: That was diagnosed; the report then has its notes and counts its rows.
        command: That made the diagnosis, for the report.

    Raises:
        InputError: The recording cannot be written.
        RobotError: The scene that the robot's figures name does not compile.
    """
    readings = readings_of(diagnosis)
    facts = facts_of(diagnosis, readings, campaign, command)
    content = diagnosis.verdict.as_json() | facts.as_json()
    _write(folder / VERDICT, json.dumps(to_jsonable(content), indent=2) + "\n")
    difference = _write_extended(diagnosis, folder)
    write_diagnosis_recording(folder / RECORDING, diagnosis, readings)
    learned = learned_of(diagnosis.naming, diagnosis.lesson)
    pictures = Pictures(
        worst=pictures_of(readings),
        learned=tuple(learned_picture(curve, learned.block.kind) for curve in facts.learned) if learned else (),
        turns_round=learned is not None and learned.turns_round,
    )
    made = {name: words for name, words in WORDS.items() if (folder / name).is_file()}
    _write(folder / REPORT, page_of(diagnosis.verdict, facts, pictures, made, difference))


def write_unweighed(verdict: Verdict, folder: Path, campaign: Campaign, robot: str, command: str = "") -> None:
    """Write verdict and report of a diagnosis that ended before anything was weighed, into an existing folder.

    Args:
        verdict: That says so.
        folder: Where to.
        campaign: That was to be diagnosed.
        robot: Title of its robot.
        command: That was to do it, for the report.
    """
    facts = facts_without(campaign, robot, command)
    _write(folder / VERDICT, json.dumps(to_jsonable(verdict.as_json() | facts.as_json()), indent=2) + "\n")
    _write(folder / REPORT, page_of(verdict, facts, Pictures(()), {VERDICT: WORDS[VERDICT]}, ""))


def _write_extended(diagnosis: Diagnosis, folder: Path) -> str:
    """Write the extended model and its difference, which is returned; "" where there is none."""
    extension = diagnosis.extension
    if extension is None:
        return ""
    acting = extension.world(diagnosis.design).acting
    compiled = diagnosis.design.replay.compiled
    edits = edits_in(World(acting=acting), Conditions.reference(compiled.n_joints))
    if not edits:
        return ""
    nominal, extended = read_spec(compiled.robot), read_spec(compiled.robot)
    for edit in edits:
        edit(extended, compiled.robot)
    nominal.compile()
    extended.compile()
    before, after = nominal.to_xml(), extended.to_xml()
    _write(folder / EXTENDED, after)
    lines = difflib.unified_diff(
        before.splitlines(True), after.splitlines(True), compiled.robot.mjcf.name, EXTENDED, n=2
    )
    difference = "".join(lines)
    _write(folder / DIFFERENCE, difference)
    return difference


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
