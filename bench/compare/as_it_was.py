"""The robot as a campaign shows it, without any named cause: what a comparison is linear about."""

from pathlib import Path

from threadpoolctl import threadpool_limits

from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.linearised_model import linearised_model_of
from bench.diagnose.replay.fitted import figures_with
from bench.diagnose.replay.levels import as_of, with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import recordings_of, segments_of
from bench.diagnose.replay.world import World, edits_in
from bench.effects.effect import Conditions
from bench.errors import NOT_SIMULATED
from bench.record.campaign import Campaign
from bench.record.carried import with_payloads
from bench.robot.compiled import CompiledRobot, compile_robot, compile_spec, read_spec
from bench.robot.folder import load_robot
from bench.robot.write import write_robot


def as_it_was(before: Campaign, compiled: CompiledRobot, folder: Path) -> CompiledRobot:
    """Return the robot with its figures fitted to what was recorded before, as it was last seen there.

    What drifts from day to day multiplies what the nominal model gets wrong: a torque constant that is another one by
    2 % moves the part of the current that a wrong inertia left over by 2 %, too. Linear about the nominal robot that is
    left out, and was named as a change of inertia.

    Args:
        before: Recordings of the machine as it was.
        compiled: The robot to begin with; it is returned where no model can be fitted to them.
        folder: For the files of the fitted robot, which have to stay for as long as it is used.
    """
    campaign = with_payloads(before)
    quantities = quantities_of(campaign.runs, compiled)
    segments = segments_of(campaign, compiled, quantities)
    if not segments:
        return compiled
    nuisances = with_recordings(nuisances_of(compiled, quantities), compiled, campaign.recordings)
    with threadpool_limits(1, "blas"):  # as all of a comparison: threads would change roundings, and cost time
        try:
            linear = linearised_model_of(Replay(compiled, segments, quantities), nuisances)
            world = as_of(refit(linear, (), {}).world(linear), recordings_of(segments)[-1])
            return _written(compiled, world, folder / "robot")
        except NOT_SIMULATED:
            return compiled


def _written(compiled: CompiledRobot, world: World, folder: Path) -> CompiledRobot:
    """Return the robot of a world in which no effect acts, from files in a folder that is made here.

    Raises:
        RobotError: The MJCF does not compile, or its files are no longer what they were.
    """
    robot, spec = compiled.robot, read_spec(compiled.robot)
    compile_spec(spec, robot, edits_in(world, Conditions.reference(compiled.n_joints)))
    readings, weights, _ = figures_with(compiled, world.deviations)
    fitted = robot.figures.fitted.model_copy(update={"readings": readings, "weights": weights})
    write_robot(robot, spec, robot.figures.model_copy(update={"fitted": fitted}), folder, "")
    return compile_robot(load_robot(folder))
