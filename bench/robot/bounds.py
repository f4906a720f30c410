"""Between which numbers a figure of a robot or of its instruments may be."""

from typing import Annotated

from pydantic import Field

from bench.record.possible import MAX_NOISE, MIN_NOISE
from bench.record.schema_words import ONE_LINE

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
# Most that a figure of a robot or of its instruments can be: far above real ones, and below what a slip of the keyboard
# or of a unit makes of them. Of a slide rad stands for m, Nm for N
SHARE = 100.0  # relative standard deviation of a figure of the model
GAIN = 10.0  # relative standard deviation of a gain, an instrument's or a torque constant's
RAD = 1.0
TURN = 7.0  # [rad], of a zero or a frame of which nobody knows where it points
M = 10.0
LEAST_M2, M2 = 1e-7, 10.0  # a piston of 0.4 mm
RAD_PER_S = 1e3
S = 10.0
N = NM = 1e7
KG = 1e5
LEAST_NM_PER_A = 1e-6  # motors of a gram make a thousand times more
NM_PER_A = RATIO = 1e6
AWAY = 1e3  # [m], of an instrument from the robot; laser trackers see 160 m far
# Of one reading; noise and steps of instruments, as of campaigns (`bench.record.possible`)
Noise = Annotated[float, Field(ge=MIN_NOISE)]
TorqueNoise = Annotated[float, Field(ge=MIN_NOISE, le=MAX_NOISE["nm"])]
Torque = Annotated[float, Field(ge=0, le=MAX_NOISE["nm"])]
Share = Annotated[float, Field(ge=0, le=SHARE)]
OneLine = Annotated[str, Field(pattern=ONE_LINE)]  # it is printed, and stands in pages
Place = Annotated[float, Field(ge=-AWAY, le=AWAY)]
