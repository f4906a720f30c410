"""Protocols on the robot in time: what rests alone leave out. Loads ring, and servos bring motors back.

The study from rest to rest has friction that remembers commands and loads only. In time a motor gives way to a load
and is brought back, so that its friction may point the other way at the next rest, whatever the approach was.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from bench.executor.contract import Executor, Progress, in_order
from bench.identify.arm import Arm
from bench.identify.from_campaign import static_readings
from bench.report.jsonable import to_jsonable
from bench.report.paper.chapter import Chapter, ChapterTable
from bench.report.paper.loading.worlds import WORLDS, World
from bench.report.paper.methods.protocols import PROTOCOLS, Protocol
from bench.report.paper.methods.study import ANALYSES
from bench.report.tables import Column, Measured, Row
from bench.robot.bodies import Array
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.loading import Loading
from bench.simulate.session import run_session

TRIED = ("above", "both-unloading", "with-load")
SHOWN = ("current", "force", "joint", "current, from the first load", "force, from the first load")


@dataclass(frozen=True)
class InTime:
    """One experiment in time; n joints.

    Attributes:
        world: Where friction sits.
        protocol: How it was done.
        error: Analysis of `SHOWN` -> shape (n,), relative error of the stiffness; nan where it could not be told.
    """

    world: World
    protocol: Protocol
    error: dict[str, Array]

    def off(self, analysis: str) -> float:
        """Return the median error over the joints."""
        return float(np.nanmedian(np.abs(self.error[analysis])))


def run_in_time(scenario: Loading, progress: Progress, executor: Executor) -> Chapter:
    """Run the loading experiment in time, in every friction world and under some protocols.

    Args:
        scenario: A loading scenario.
        progress: Called with the share that is done.
        executor: Where to simulate.
    """
    protocols = [protocol for protocol in PROTOCOLS if protocol.name in TRIED]
    jobs = [(scenario, world, protocol) for world in WORLDS for protocol in protocols]
    found = in_order(executor, _in_time, jobs, progress)
    table = ChapterTable(
        "Median error of the stiffness, one campaign each",
        [Column(name, "%", 1) for name in SHOWN],
        [
            Row(f"{each.world.title}: {each.protocol.name}", tuple(Measured(100 * each.off(name)) for name in SHOWN))
            for each in found
        ],
    )
    data = {
        f"{each.world.name}, {each.protocol.name}": {name: to_jsonable(error) for name, error in each.error.items()}
        for each in found
    }
    return Chapter("in-time", "Protocols in time", (), in_time_sentences(found), data, (table,))


def in_time_sentences(found: Sequence[InTime]) -> list[str]:
    """Return how far off each analysis is in the worst of the worlds, by protocol."""
    sentences = []
    for protocol in dict.fromkeys(each.protocol for each in found):
        worst = {name: max(each.off(name) for each in found if each.protocol == protocol) for name in SHOWN}
        listed = ", ".join(f"{name} {100 * off:.1f} %" for name, off in worst.items())
        sentences.append(f"In time, {protocol.title}: at worst over the friction worlds {listed}.")
    return sentences


def _in_time(job: tuple[Loading, World, Protocol], progress: Progress) -> InTime:
    scenario, world, protocol = job
    robot = load_robot(scenario.robot)
    arm = Arm(rigid_bodies(compile_robot(robot)))
    changes = {"friction": world.friction, "servo": world.servo, "orientation": False}
    done = protocol.of(scenario, arm, robot.figures.load_point).model_copy(update=changes)
    session = run_session(done, progress)
    readings = static_readings(session.campaign, robot.figures)
    error = {}
    with threadpool_limits(1, "blas"):
        for name in SHOWN:
            analysis = ANALYSES[name]
            used = readings.among_loaded() if analysis.among_loaded else readings
            estimate = analysis.method(arm, session.compiled.counterbalance, used, analysis.options)
            error[name] = estimate.stiffness / session.compiled.stiffness - 1
    return InTime(world, protocol, error)
