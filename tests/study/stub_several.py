"""A study of several recordings whose machines are not simulated."""

from bench.executor.contract import Executor, Progress
from bench.study.machines import MachineTrial
from bench.study.several import JointAnswer, Machines, SeveralOutcome, SeveralSettings

NOTHING = JointAnswer("a loss of gas", ("gas_loss", "robot"), "", (), False)


class Instant(Machines):
    """Answers at once that nothing was found.

    Args:
        settings: Of the study.
        done: Names of the machines that were made.
    """

    def __init__(self, settings: SeveralSettings, done: list[str]) -> None:
        super().__init__(settings)
        object.__setattr__(self, "done", done)

    def prepare(self, executor: Executor) -> None:
        pass

    def __call__(self, trial: MachineTrial, _: Progress) -> SeveralOutcome:
        self.done.append(trial.name)  # type: ignore[attr-defined]
        return SeveralOutcome(trial.name, trial.kind, NOTHING, None, "", 0.0, 0.0)
