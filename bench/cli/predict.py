"""`bench predict`: a model against recordings that it was not fitted to."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from bench.cli.command_line import command_line

if TYPE_CHECKING:
    from bench.predict.prediction import Prediction
    from bench.record.campaign import Campaign
    from bench.robot.compiled import CompiledRobot

BROKEN = 8  # exit code


@dataclass(frozen=True)
class Predict:
    """Hold a model against recordings, without any refit: its error in every channel, and whether promises hold.

    A second for ten of motion, half a minute for a whole session. A diagnosis promises within what its model will err
    in each channel of the next recording; this says whether it does, beside the nominal robot and what no model can
    predict (bench/predict/README.md).
    """

    model: tyro.conf.Positional[str]
    """Robot that predicts, name or folder; the folder of a diagnosis stands for the robot that it handed over."""
    campaign: tyro.conf.Positional[tuple[Path, ...]]
    """Campaign folders; every recording in them is predicted on its own."""
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Folder to write (page, numbers, Rerun recordings); must not exist yet. By default nothing is written."""
    free: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """What may be anew in each recording, and is fitted, such as encoder_zero; give it once for each name. An unknown
    name lists all."""
    nominal: str = ""
    """Robot to compare with, name or folder; by default the one that the campaign names."""
    despite_doubts: bool = False
    """Go on although channels failed plausibility checks; by default that ends in an error."""

    def run(self) -> int:
        """Predict, print and write; return the exit code: 0, or 8 where an error is larger than promised."""
        from contextlib import ExitStack

        from bench.cli.joints import by_number
        from bench.cli.progress import phases
        from bench.predict.free import checked
        from bench.predict.predict import predict
        from bench.predict.promises import read_promises
        from bench.record.folder import new_folder
        from bench.report.prediction.file_names import NUMBERS
        from bench.report.prediction.model import known_of
        from bench.report.prediction.words import places_of, words_of
        from bench.report.prediction.write import write_prediction

        checked(self.free)
        sentences: tuple[str, ...] = ()
        with ExitStack() as stack:  # a place where nothing can be written is refused before the work
            folder = stack.enter_context(new_folder(self.out, NUMBERS, replace=False)) if self.out else None
            campaign, model, nominal = self._opened()
            promises = read_promises(model.robot.folder)
            shown = stack.enter_context(phases())
            prediction: Prediction = predict(
                campaign, model, nominal, promises, self.free, known_of(model.robot.folder), shown.phase
            )
            if folder:
                shown.phase("writing")
                sentences = write_prediction(prediction, folder, self.command)
        for line in (*by_number(model), *words_of(prediction)):
            print(line)
        for sentence in sentences:
            print(sentence)
        if self.out:
            for line in places_of(self.out, prediction):
                print(line)
        return BROKEN if prediction.is_broken else 0

    def _opened(self) -> "tuple[Campaign, CompiledRobot, CompiledRobot]":
        """Return the campaigns as one, the robot that predicts, and the nominal one.

        Raises:
            CampaignError: A campaign cannot be used.
            RobotError: A robot is unknown or broken.
        """
        from bench.cli.doubts import heed
        from bench.errors import CampaignError
        from bench.report.campaigns import open_usable, robot_of
        from bench.report.joint_campaign import open_joint
        from bench.report.prediction.model import load_model
        from bench.robot.compiled import compile_robot
        from bench.robot.folder import load_robot

        joint = open_joint(self.campaign, load_model(self.model))
        heed(joint.warnings, joint.doubts, despite_doubts=self.despite_doubts)
        stated = joint.campaign.robot
        for folder in self.campaign if self.nominal else ():
            try:
                open_usable(folder, self.nominal)
            except CampaignError as error:
                raise CampaignError(f"--nominal {self.nominal}: is another robot. {error}") from error
        nominal = load_robot(self.nominal) if self.nominal else robot_of(self.campaign[0], stated)
        return joint.campaign, joint.compiled, compile_robot(nominal)

    @property
    def command(self) -> str:
        """What to type to do it again."""
        return command_line("predict", self)
