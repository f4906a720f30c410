"""`bench diagnose`: what the simulation gets wrong about a campaign."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from bench.cli.command_line import command_line

if TYPE_CHECKING:
    from bench.diagnose.replay.given import Posterior
    from bench.robot.folder import Robot


@dataclass(frozen=True)
class Diagnose:
    """Say what the nominal model gets wrong about measured data, name the cause, and write the robot as fitted.

    Half a minute where little is wrong, minutes where the model lacks much. A cause is taken only where it pays on runs
    it was not fitted to; the threshold is such that chance alone passes it in 1 of 100 campaigns. How often it is right
    stands in the README.

    Of moving data it prints a first pass by least squares within seconds, and says at the end where that predicts
    torques better than what was found.

    Of several campaigns each is a recording: what is the machine's is fitted to all of them and has to predict those
    that were left out; a payload, the zero of an encoder or the tracker's frame is looked for in each.
    """

    campaigns: tyro.conf.Positional[tuple[Path, ...]]
    """Campaign folders of one machine (format: bench/record/README.md), in the order in which they were recorded."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """Folder to write; must not exist yet."""
    robot: str = ""
    """Robot to take, name or folder, such as the one that a diagnosis handed over; by default the campaign names it."""
    given: Path | None = None
    """Folder of an earlier diagnosis of this machine: its robot is the nominal one, and what it knew of figures and
    findings is the prior."""
    file: tuple[Path, ...] = ()
    """Python files with effects of your own (bench/effects/README.md)."""
    despite_doubts: bool = False
    """Go on although channels failed plausibility checks; by default that ends in an error."""
    cores: int = 0
    """Processes; 0: one for each core. The verdict does not depend on it."""
    at_most: str | None = None
    """Time after which to end with what was found so far, such as 90, 60s or 2m; so does Ctrl-C."""
    store: bool = True
    """Keep simulated signatures on disk for later, and use those that are kept (bench/store/README.md)."""

    def run(self) -> int:
        """Diagnose, print and write; return the exit code: 0, or 7 for a verdict that is unfinished."""
        from math import inf

        from bench.cli.doubts import heed
        from bench.cli.joints import by_number
        from bench.cli.progress import phases
        from bench.cli.stopping import UNFINISHED, ending_on_interrupt, seconds_of
        from bench.diagnose.baseline.changed_friction import changed_friction
        from bench.diagnose.baseline.first_look import first_look
        from bench.diagnose.diagnose import FALSE_ALARM_RATE, diagnose
        from bench.diagnose.verdict import unweighed
        from bench.effects.catalogue import catalogue
        from bench.effects.own import try_out
        from bench.executor.local import on_cores
        from bench.executor.watched import Stop, Stopped, Watched
        from bench.record.folder import new_folder
        from bench.report.diagnosis.baseline import changed_lines, first_lines
        from bench.report.diagnosis.file_names import VERDICT
        from bench.report.diagnosis.words import places_of
        from bench.report.diagnosis.write import write_diagnosis, write_unweighed
        from bench.report.handover.given_words import given_sentence
        from bench.report.joint_campaign import open_joint
        from bench.store.place import open_store

        stop = Stop(inf if self.at_most is None else seconds_of(self.at_most))
        effects = catalogue(self.file)
        robot, posterior = self._start()
        with self._asking_about_the_robot():
            joint = open_joint(self.campaigns, robot)
            campaign, compiled = joint.campaign, joint.compiled
            try_out([effect for name, effect in effects.items() if name not in catalogue()], compiled)
            heed(joint.warnings, joint.doubts, despite_doubts=self.despite_doubts)
        with ending_on_interrupt(stop), new_folder(self.out, VERDICT, replace=False) as folder, phases() as shown:
            executor = Watched(on_cores(self.cores), shows=shown.share)
            during = "reading the campaign"
            sentences: tuple[str, ...] = ()
            taken = ""

            def phase(words: str) -> None:
                nonlocal during
                during = words
                shown.phase(words)

            try:
                phase("first pass by least squares")
                stop.check()
                look = first_look(campaign, compiled)
                first = (*first_lines(look), *changed_lines(changed_friction(campaign, compiled)))
                for line in (*first, "") if first else ():
                    print(line, flush=True)
                store = open_store() if self.store else None
                found = diagnose(
                    campaign,
                    compiled,
                    effects,
                    progress=phase,
                    executor=executor,
                    check=stop.check,
                    store=store,
                    given=posterior,
                    first=look.found,
                )
                verdict = found.verdict
                taken = given_sentence(posterior, found.linear.nuisances) if posterior else ""
                sentences = write_diagnosis(found, folder, campaign, self.command)
            except Stopped as stopped:
                verdict = unweighed(FALSE_ALARM_RATE, str(stopped), during)
                sentences = write_unweighed(verdict, folder, campaign, compiled.robot.figures.titled, self.command)
        for line in (*by_number(compiled), *sentences, *filter(None, (taken,))):
            print(line)
        for line in places_of(self.out):
            print(line)
        return UNFINISHED if verdict.unfinished else 0

    def _start(self) -> "tuple[str | Robot, Posterior | None]":
        """Return the robot to take, "" for the one that the campaign names, and what an earlier diagnosis knew of it.

        What the robot carried is left out: it was that recording's, and is looked for anew.

        Raises:
            InputError: Both a robot and an earlier diagnosis are given.
            RobotError: The folder holds no robot that a diagnosis handed over, or no posterior.
        """
        from bench.effects.payloads import carrying_nothing
        from bench.errors import InputError
        from bench.report.handover.posterior_file import read_posterior
        from bench.report.prediction.model import handed_over
        from bench.robot.folder import load_robot

        if self.given is None:
            return self.robot, None
        if self.robot:
            raise InputError("--given and --robot: an earlier diagnosis brings its own robot; give one of the two.")
        robot = Path(handed_over(self.given))
        posterior = read_posterior(robot)
        return carrying_nothing(load_robot(robot)), posterior

    @contextmanager
    def _asking_about_the_robot(self) -> Iterator[None]:
        """Add to what is wrong with campaigns that an earlier diagnosis may be of another robot.

        Raises:
            CampaignError: What was raised, with a sentence more where a diagnosis is given.
        """
        from bench.errors import CampaignError

        try:
            yield
        except CampaignError as error:
            if self.given is None:
                raise
            asked = f"--given {self.given}: was that found on the robot of these campaigns? They are held against it."
            raise CampaignError([*error.problems, asked]) from error

    @property
    def command(self) -> str:
        """What to type to do it again."""
        return command_line("diagnose", self)
