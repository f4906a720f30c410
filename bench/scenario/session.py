"""The standard session: what a lab can measure of one robot in a day, in parts of which every one can be missing."""

from collections.abc import Iterator
from typing import Literal, Self

from pydantic import Field, model_validator

from bench.errors import InputError, ScenarioError
from bench.record.strict import Strict
from bench.robot.bodies import Array
from bench.robot.folder import Robot
from bench.scenario.dwell import DwellPart
from bench.scenario.line import LinePart
from bench.scenario.loading import LoadingPart
from bench.scenario.rotation import RotationPart
from bench.scenario.types import Pause, ScenarioBase

Part = DwellPart | LinePart | LoadingPart | RotationPart


class RepeatedPart(Strict):
    """What is measured at the start and once more at the end: drift, warm-up and gas loss show between the two."""

    loading: LoadingPart | None = None
    rotation: RotationPart | None = None


class SessionScenario(ScenarioBase):
    """Keys of a session scenario. Its parts are run in the order below, with breaks that are not simulated."""

    experiment: Literal["session"]
    repeat_at_end: RepeatedPart | None = None
    loading: LoadingPart | None = None
    rotations: tuple[RotationPart, ...] = ()
    line: LinePart | None = None
    dwell: DwellPart | None = None
    break_s: Pause = Field(300.0, description="between parts: rigging, moving the tracker's target, a coffee")

    @model_validator(mode="after")
    def _has_parts(self) -> Self:
        if not any(True for _ in self.parts()):
            raise ValueError("a session needs a part: loading, rotations, line, dwell or repeat_at_end")
        return self

    def parts(self) -> Iterator[tuple[str, str, Part]]:
        """Yield the parts in the order in which they are run, each as (key in the file, prefix of its runs, part).

        The prefix of the line is empty: its runs are known by their names.
        """
        repeated = self.repeat_at_end
        ends = {} if repeated is None else {"loading": repeated.loading, "rotation": repeated.rotation}
        for key, part in ends.items():
            if part:
                yield f"repeat_at_end.{key}", "first-" + _short(part), part
        if self.loading:
            yield "loading", "", self.loading
        seen: dict[int, int] = {}
        for i, rotation in enumerate(self.rotations):
            seen[rotation.joint] = seen.get(rotation.joint, 0) + 1
            again = f"{seen[rotation.joint]}-" if seen[rotation.joint] > 1 else ""
            yield f"rotations[{i}]", _short(rotation) + again, rotation
        if self.line:
            yield "line", "", self.line
        if self.dwell:
            yield "dwell", "", self.dwell
        for key, part in ends.items():
            if part:
                yield f"repeat_at_end.{key}", "last-" + _short(part), part

    def without(self, *keys: str) -> Self:
        """Return the session without some of its parts.

        Raises:
            InputError: No part is left.
        """
        content = self.model_dump(exclude=set(keys))
        if not any(content.get(key) for key in PARTS):
            raise InputError(f"nothing is left of the session without {', '.join(keys)}.")
        return type(self).model_validate(content)

    def check(self, robot: Robot, limits: Array) -> None:
        """Hold every part against the robot.

        Args:
            robot: The robot it is to run on.
            limits: Shape (n, 2) [rad], ranges of the link joints.

        Raises:
            ScenarioError: Some part does not fit; every fault of every part is listed.
        """
        problems: dict[str, None] = {}
        for key, _, part in self.parts():
            try:
                part.check(robot, limits)
            except ScenarioError as error:
                problems |= dict.fromkeys(f"{key}.{problem}" for problem in error.problems)
        if problems:
            raise ScenarioError(problems)


PARTS = ("repeat_at_end", "loading", "rotations", "line", "dwell")


def _short(part: Part) -> str:
    return f"joint{part.joint}-" if isinstance(part, RotationPart) else ""
