"""What every scenario file says, whatever its experiment. Experiments add their own keys (`bench.scenario.loading`)."""

from typing import Annotated, Literal

from pydantic import Field

from bench.record.strict import Strict

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
DAY_S = 86400.0  # [s]; longer than any part of an experiment, and a day of readings fits into memory
Seconds = Annotated[float, Field(gt=0, le=DAY_S)]
Pause = Annotated[float, Field(ge=0, le=DAY_S)]
SpeedShare = Annotated[float, Field(ge=1e-4, le=1)]  # of the drives' speed limit; assumed: less is no motion
Acceleration = Annotated[float, Field(ge=1e-3)]  # [deg/s^2], as well
MOST_REPEATS = 10_000  # assumed: a thousand times what a laboratory reads at one pose; more never ends
FrictionSide = Literal["as-model", "motor", "link", "none"]


class ScenarioBase(Strict):
    """Keys that every scenario has.

    `friction` puts the robot into one of the friction worlds: "as-model" leaves both sides as the MJCF has them; "link"
    and "motor" put the level of the link-side element on that side and none on the other; "none" removes both.
    `servo`: "integral" holds the motor angle at its command under load, "proportional" gives by torque / kp.
    """

    robot: str = Field(description="name of a robot folder, or a path to one")
    seed: int = Field(0, ge=0)
    friction: FrictionSide = "as-model"
    servo: Literal["integral", "proportional"] = "integral"
    perfect_instruments: bool = False
    notes: str = ""
