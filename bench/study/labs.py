"""A lab of the study: a session, the instruments that are there, and what all its campaigns have in common."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.effects.effect import Acting, Effect, Place
from bench.effects.recorded import Recorded
from bench.errors import InputError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.hide.campaign import Hidden, hide_campaign
from bench.hide.plan import legs_of
from bench.hide.recorded import recorded_of
from bench.hide.second_plant import run_second
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot, load_robot
from bench.robot.instruments import LinkEncoder
from bench.scenario.files import read_scenario
from bench.scenario.rotation import RotationPart
from bench.scenario.session import SessionScenario
from bench.second.worlds import World
from bench.study.blind import diagnose_with
from bench.study.limits import Blur

SESSION = "session-study"
BRIEF = 15.0  # [deg]
ACCURATE = 1e-5  # [rad], of an encoder on a link: 2 arc seconds, as ring encoders of its size are sold


@dataclass(frozen=True)
class Lab:
    """What is done, and with which instruments.

    Attributes:
        session: Name or file of the session.
        without: Instruments, channels and parts of the session that are missing, as in `hide_campaign`.
        channels: Further channels.
        is_brief: Rotations are run over 15 degrees in the middle, with the heaviest payload only.
        link_encoder: The first joint has an encoder on its link too.
    """

    session: str = SESSION
    without: tuple[str, ...] = ()
    channels: tuple[str, ...] = ()
    is_brief: bool = False
    link_encoder: bool = False

    def scenario(self) -> SessionScenario:
        """Read the session.

        Raises:
            InputError: There is none of that name, or it is another kind of scenario.
        """
        session = read_scenario(self.session)
        if not isinstance(session, SessionScenario):
            raise InputError(f"{self.session}: is no session; take session-study or session-short.")
        if not self.is_brief:
            return session
        return session.model_copy(update={"rotations": tuple(_brief(part) for part in session.rotations)})

    def robot(self) -> Robot:
        """Load the robot with the instruments that it has there."""
        robot = load_robot(self.scenario().robot)
        if not self.link_encoder:
            return robot
        figures = robot.figures
        encoder = LinkEncoder(joints=(figures.drives[0].joint,), accuracy_rad=ACCURATE)
        instruments = figures.instruments.model_copy(update={"link_encoder": encoder})
        return replace(robot, figures=figures.model_copy(update={"instruments": instruments}))

    def words(self) -> str:
        """Return what is done, in words."""
        session = self.scenario()
        legs = legs_of(self.robot(), session)
        minutes = sum(leg.course.seconds + leg.pause_s for leg in legs) / 60
        runs = dict.fromkeys(step.mark.run for leg in legs for step in leg.course.steps if step.mark)
        return f"{len(runs)} runs on {session.robot} in {minutes:.0f} minutes with breaks."

    def compiled(self) -> CompiledRobot:
        """Compile the nominal robot."""
        return compile_robot(self.robot())

    def places(self, effect: Effect, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return where an effect can act in a campaign of this lab, in a channel or from a run on among others.

        A study makes no first pass: what is looked for only where one has it has no place there.
        """
        return () if effect.only_if_told else effect.places_in(compiled, _recorded(self))

    def hide(self, acting: tuple[Acting, ...], rng: np.random.Generator, gives: bool = False) -> Hidden:
        """Make a campaign in which some effects act: half the step, Student's t, background errors, warm-up.

        Args:
            acting: The effects.
            rng: Random numbers.
            gives: Servos have no integral action.
        """
        session = self.scenario()
        if gives:
            session = session.model_copy(update={"servo": "proportional"})
        return hide_campaign(self.robot(), session, acting, rng, without=self.without, channels=self.channels)

    def hide_in_second(
        self,
        acting: tuple[Acting, ...],
        rng: np.random.Generator,
        rests: bool = False,
        machine: np.random.Generator | None = None,
    ) -> Campaign:
        """Make a campaign of the second plant in which some effects act, with its friction and servos at random.

        Args:
            acting: The effects.
            rng: Random numbers.
            rests: Links rest anywhere that their friction holds them.
            machine: Source of what lasts from recording to recording, its friction and servos among it; None: all of
                it comes from `rng`.

        Raises:
            InputError: The lab has a channel or an encoder that the second plant has not.
        """
        if self.channels or self.link_encoder:
            raise InputError("the second plant has neither a thermometer in its gas nor encoders on its links.")
        world = World.draw(rng if machine is None else machine, rests)
        done = run_second(
            self.robot(), self.scenario(), acting, rng, world=world, without=self.without, machine=machine
        )
        return done.campaign


@lru_cache(maxsize=4)
def _recorded(lab: Lab) -> Recorded:
    return recorded_of(lab.robot(), lab.scenario(), lab.without, lab.channels)


@dataclass(frozen=True, eq=False)
class Setup:
    """What the campaigns of a lab share; all of it comes from the nominal robot and one null campaign.

    Attributes:
        lab: The lab.
        compiled: The nominal robot.
        catalogue: Effects to look for.
        linear: The linearised model of the null campaign, for detection limits.
        blur: The same campaign, as narrow effects blur in it.
        threshold: Log evidence that chance exceeds at the declared rate.
        listed: Whitened signatures of all causes, shape (m, k) each.
    """

    lab: Lab
    compiled: CompiledRobot
    catalogue: Mapping[str, Effect]
    linear: LinearisedModel
    blur: Blur
    threshold: float
    listed: tuple[Array, ...]


def machine_components(
    catalogue: Mapping[str, Effect], lab: Lab, compiled: CompiledRobot
) -> Iterator[tuple[Effect, Place]]:
    """Yield every effect of a catalogue at every place where it can act in a lab; errors of the recording left out."""
    for effect in catalogue.values():
        if getattr(effect, "level", "machine") == "machine":
            for place in lab.places(effect, compiled):
                yield effect, place


def prepare(
    lab: Lab,
    catalogue: Mapping[str, Effect],
    rng: np.random.Generator,
    progress: Callable[[str], None] = lambda words: None,
    executor: Executor = SERIAL,
) -> Setup:
    """Return what the campaigns of a lab share.

    Args:
        lab: The lab.
        catalogue: Effects to look for.
        rng: Of the null campaign.
        progress: Called with what is done next.
        executor: Where to simulate.
    """
    compiled = lab.compiled()
    progress("a null campaign")
    campaign = lab.hide((), rng).campaign
    diagnosis = diagnose_with(campaign, compiled, catalogue, progress=progress, executor=executor)
    tried = diagnosis.naming.tried
    listed = tuple(tried.columns_of(entry) for entry in tried.entries if entry.cause)
    linear, threshold = diagnosis.linear, diagnosis.verdict.threshold
    return Setup(lab, compiled, catalogue, linear, Blur(linear.replay), threshold, listed)


def _brief(part: RotationPart) -> RotationPart:
    """Return a sweep of 15 degrees in the middle, where levers change least."""
    first, last = part.start_deg[part.joint - 1], part.end_deg
    half = float(np.clip((last - first) / 2, -BRIEF / 2, BRIEF / 2))
    middle = (first + last) / 2
    start = tuple(middle - half if i == part.joint - 1 else angle for i, angle in enumerate(part.start_deg))
    return part.model_copy(
        update={"start_deg": start, "end_deg": middle + half, "payloads_kg": (max(part.payloads_kg),)}
    )
