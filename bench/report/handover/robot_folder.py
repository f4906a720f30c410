"""The robot folder that a diagnosis hands over: what was fitted is in its MJCF and in its figures."""

import difflib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.fitted import figures_with, zeros_in
from bench.diagnose.replay.given import EARLIER
from bench.diagnose.replay.instants import recordings_of
from bench.diagnose.replay.levels import handed_over
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL, World, edits_in
from bench.effects.conditions import Conditions
from bench.effects.division import divided, payload_as_body
from bench.effects.effect import Acting
from bench.effects.fitted import acting_of, entry_of
from bench.errors import NOT_SIMULATED, RobotError
from bench.report.handover.drive_readings import with_drive_readings
from bench.report.handover.readme import readme_of
from bench.robot.compiled import CompiledRobot, compile_robot, compile_spec, read_spec
from bench.robot.fitted import Fitted, FittedEffect
from bench.robot.folder import load_robot
from bench.robot.write import write_robot
from bench.robot.xml import xml_of
from bench.simulate.prescribed import TOLERANCE

# Of the torques on the links, where balances count as found when folder and fit are compared: as closely as both find
# them, so that rounding is not all that differs. Kinks of a torque table do not allow the closest.
TOLERANCES = (1e-9, 1e-8, 1e-7, TOLERANCE)
AS_FITTED = ", as fitted"
README = "README.md"


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


def hand_over(linear: LinearisedModel, fit: Fit, folder: Path, nominal: Path, unfinished: str = "") -> Handed:
    """Write the robot as fitted.

    What acts by its changes alone (friction that joints held at rest) belongs to the campaign and is left out. Of what
    belongs to one recording, such as a payload or the zero of an encoder, the last recording's is written; of what
    drifts from day to day, the mean of all days.

    Args:
        linear: The campaign.
        fit: To all of it.
        folder: Of the new robot; made here.
        nominal: File for the nominal robot's MJCF as MuJoCo writes it, which the difference is against.
        unfinished: Why the diagnosis ended before it was done.

    Raises:
        RobotError: The robot's files are no longer what they were when they were read.
    """
    compiled, recordings = linear.replay.compiled, recordings_of(linear.segments)
    world, last = handed_over(fit.world(linear), recordings), recordings[-1]
    robot = compiled.robot
    division = divided(compiled, (*world.acting, *zeros_in(world, compiled)))
    before, spec = read_spec(robot), read_spec(robot)
    before.compile()
    text = xml_of(before)
    nominal.write_text(text, encoding="utf-8")
    edits = edits_in(World(world.deviations, division.in_model), Conditions.reference(compiled.n_joints))
    in_model = compile_spec(spec, robot, [*edits, payload_as_body])
    beside, missing = _written_down(division.beside, in_model)
    readings, weights, left = figures_with(compiled, world.deviations)
    missing += [f"{nuisance.name}: figures have no place for it" for nuisance in left]
    effects = (*robot.figures.fitted.effects, *(entry for _, entry in beside))
    title = robot.figures.title.removesuffix(AS_FITTED) + AS_FITTED
    of_last = last if len(recordings) > 1 else ""
    fitted = Fitted(readings=readings, weights=weights, effects=effects, unfinished=unfinished, recording=of_last)
    figures = robot.figures.model_copy(update={"title": title, "fitted": fitted})
    figures = with_drive_readings(figures, linear, [*linear.replay.fitted.acting, *(one for one, _ in beside)])
    folder.mkdir()
    after = write_robot(robot, spec, figures, folder, "")
    disagreement = _disagreement(linear, world, compile_robot(load_robot(folder)))
    readme = readme_of(robot, figures, missing, disagreement, of_last)
    (folder / README).write_text(readme, encoding="utf-8")
    name = f"{folder.name}/{figures.mjcf}"
    lines = difflib.unified_diff(text.splitlines(True), after.splitlines(True), nominal.name, name, n=2)
    return Handed("".join(lines), tuple(missing), disagreement)


def _written_down(
    acting: Sequence[Acting], in_model: CompiledRobot
) -> tuple[list[tuple[Acting, FittedEffect]], list[str]]:
    """Return the effects that figures can hold, each with its entry, and words about the others.

    Args:
        acting: Effects.
        in_model: The robot with everything that its MJCF holds.
    """
    found, missing = [], []
    for one in acting:
        entry = entry_of(one)
        if entry is None:
            missing.append(f"the effect {one}: it is defined in a file of your own")
        elif not _means(entry, one, in_model):
            missing.append(f"the effect {one}: it is of this campaign, for the robot alone has no such place")
        else:
            found.append((one, entry))
    return found, missing


def _means(entry: FittedEffect, acting: Acting, compiled: CompiledRobot) -> bool:
    """Whether an entry is read as the effect that it was written for; ids of bodies may differ."""
    try:
        again = acting_of(entry, compiled)
    except RobotError:
        return False
    return replace(again.place, index=acting.place.index) == acting.place and again.values == acting.values


def _disagreement(linear: LinearisedModel, world: World, handed: CompiledRobot) -> float:
    """Return `Handed.disagreement`, along the last recording; what an earlier diagnosis said is no reading of a robot.

    Args:
        linear: The campaign.
        world: As handed over.
        handed: The new robot.
    """
    last = recordings_of(linear.segments)[-1]
    segments = tuple(segment for segment in linear.segments if segment.recording == last)
    nominal, campaign = linear.replay.compiled, (segments, linear.quantities)
    sigma = np.concatenate([segment.sigma for segment in segments])
    for tolerance in TOLERANCES:
        try:
            expected = Replay(nominal, *campaign, tolerance).predict(world)
            found = Replay(handed, *campaign, tolerance).predict(NOMINAL)
        except NOT_SIMULATED:
            continue
        scale = np.nanmax(np.fmax(np.abs(expected), sigma), axis=0)
        read = [quantity != EARLIER for quantity in linear.quantities]
        return float(np.nanmax((np.abs(found - expected) / scale)[:, read]))
    return float("nan")
