"""The files of a diagnosis: verdict.json, and where a cause was named the extended model and its difference."""

import difflib
import json
from pathlib import Path

from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.replay import World, edits_in
from bench.effects.effect import Conditions
from bench.report.plain import plain
from bench.robot.compiled import read_spec

VERDICT = "verdict.json"
EXTENDED = "extended.xml"
DIFFERENCE = "extended.diff"


def write_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """Write the files of a diagnosis into an existing folder.

    Effects of instruments do not stand in the model; with them alone there is no extended model.
    """
    text = json.dumps(plain(diagnosis.verdict.as_json()), indent=2) + "\n"
    (folder / VERDICT).write_text(text, encoding="utf-8")
    if not diagnosis.naming.hypotheses:
        return
    acting = diagnosis.naming.hypotheses[0].fit.world(diagnosis.design).acting
    compiled = diagnosis.design.replay.compiled
    edits = edits_in(World(acting=acting), Conditions.reference(compiled.n_joints))
    if not edits:
        return
    nominal, extended = read_spec(compiled.robot), read_spec(compiled.robot)
    for edit in edits:
        edit(extended, compiled.robot)
    nominal.compile()
    extended.compile()
    before, after = nominal.to_xml(), extended.to_xml()
    (folder / EXTENDED).write_text(after, encoding="utf-8")
    lines = difflib.unified_diff(
        before.splitlines(True), after.splitlines(True), compiled.robot.mjcf.name, EXTENDED, n=2
    )
    (folder / DIFFERENCE).write_text("".join(lines), encoding="utf-8")
