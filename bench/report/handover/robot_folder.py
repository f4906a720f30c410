"""The robot folder that a diagnosis hands over: what was fitted is in its MJCF and in its figures."""

import difflib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.picture.design import Design
from bench.diagnose.replay.fitted import figures_with
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL, World, edits_in
from bench.effects.effect import Conditions
from bench.effects.fitted import entry_of
from bench.errors import NOT_SIMULATED
from bench.report.handover.division import divided, payload_as_body
from bench.report.handover.drive_readings import with_drive_readings
from bench.report.handover.readme import readme_of
from bench.robot.compiled import CompiledRobot, compile_robot, read_spec
from bench.robot.fitted import Fitted
from bench.robot.folder import load_robot
from bench.robot.write import write_robot
from bench.robot.xml import xml_of
from bench.simulate.prescribed import TOLERANCE

# Of the torques on the links, where balances count as found when folder and fit are compared: as closely as both find
# them, so that rounding is not all that differs. Kinks of a torque table do not allow the closest.
TOLERANCES = (1e-9, 1e-8, 1e-7, TOLERANCE)
AS_FITTED = ", as fitted"


@dataclass(frozen=True)
class Handed:
    """What was handed over.

    Attributes:
        difference: Of the MJCF against the nominal one, both as MuJoCo writes them; unified, as `patch` takes it.
        missing: What the folder lacks of the fit, in words; each an item.
        disagreement: Largest difference between predictions of the folder and of the fit, relative to the largest
            reading that the fit predicts of a channel, or to its standard error where that is larger; nan where the
            folder's model finds no balance from scratch.
    """

    difference: str
    missing: tuple[str, ...]
    disagreement: float


def hand_over(design: Design, fit: Fit, folder: Path, nominal: Path) -> Handed:
    """Write the robot as fitted.

    What acts by its changes alone (friction that joints held at rest) belongs to the campaign and is left out.

    Args:
        design: The campaign.
        fit: To all of it.
        folder: Of the new robot; made here.
        nominal: File for the nominal robot's MJCF as MuJoCo writes it, which the difference is against.

    Raises:
        RobotError: The robot's files are no longer what they were when they were read.
    """
    compiled, world = design.replay.compiled, fit.world(design)
    robot = compiled.robot
    division = divided(compiled, world.acting)
    missing, kept, entries = [], [*design.replay.fitted.acting], [*robot.figures.fitted.effects]
    for one in division.beside:
        entry = entry_of(one)
        if entry:
            kept.append(one)
            entries.append(entry)
        else:
            missing.append(f"the effect {one}: it is defined in a file of your own")
    readings, weights, left = figures_with(compiled, world.deviations)
    missing += [f"{nuisance.name}: figures have no place for it" for nuisance in left]
    fitted = Fitted(readings=readings, weights=weights, effects=tuple(entries))
    title = robot.figures.title.removesuffix(AS_FITTED) + AS_FITTED
    figures = robot.figures.model_copy(update={"title": title, "fitted": fitted})
    figures = with_drive_readings(figures, design, kept)
    before, spec = read_spec(robot), read_spec(robot)
    before.compile()
    text = xml_of(before)
    nominal.write_text(text, encoding="utf-8")
    for edit in edits_in(World(world.deviations, division.in_model), Conditions.reference(compiled.n_joints)):
        edit(spec, robot)
    payload_as_body(spec, robot)
    spec.compile()
    folder.mkdir()
    after = write_robot(robot, spec, figures, folder, "")
    disagreement = _disagreement(design, world, compile_robot(load_robot(folder)))
    readme = readme_of(robot, figures, missing, disagreement)
    (folder / "README.md").write_text(readme, encoding="utf-8")
    name = f"{folder.name}/{figures.mjcf}"
    lines = difflib.unified_diff(text.splitlines(True), after.splitlines(True), nominal.name, name, n=2)
    return Handed("".join(lines), tuple(missing), disagreement)


def _disagreement(design: Design, world: World, handed: CompiledRobot) -> float:
    """Return `Handed.disagreement`."""
    nominal, campaign = design.replay.compiled, (design.segments, design.quantities)
    sigma = np.concatenate([segment.sigma for segment in design.segments])
    for tolerance in TOLERANCES:
        try:
            expected = Replay(nominal, *campaign, tolerance).predict(world)
            found = Replay(handed, *campaign, tolerance).predict(NOMINAL)
        except NOT_SIMULATED:
            continue
        scale = np.nanmax(np.fmax(np.abs(expected), sigma), axis=0)
        return float(np.nanmax(np.abs(found - expected) / scale))
    return float("nan")
