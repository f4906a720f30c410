"""The first pass: which samples tell a drive's friction."""

import numpy as np

from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import DRIVE_COLUMNS, equations_of
from bench.identify.dynamics.samples import MotionSamples
from tests.diagnose.assumed.registry import needs
from tests.identify.dynamics.rigid_world import arm, robot

FRICTION = 10.0  # [Nm]
BAND = Band(10.0, np.nan)


@needs("identify.dynamics.equations.MOSTLY")
def friction_that_holds_on_at_the_turns_is_no_offset_of_the_torque() -> None:
    time = np.arange(0, 20, 0.002)
    position, torque = np.zeros((len(time), 3)), np.zeros((len(time), 3))
    turned = 2 * np.pi * time
    position[:, 0] = 0.3 * np.sin(turned)
    share = np.cos(turned)  # of the top speed; about the turns friction stays where it was, always at one side
    torque[:, 0] = np.where(np.abs(share) > 0.08, FRICTION * np.sign(share), FRICTION)
    samples = MotionSamples("r", "", 500.0, time, position, position, torque, np.zeros((len(time), 6)), 0 * time)
    nominal = robot(arm())
    found = equations_of(samples, BAND, Arm(nominal.bodies), nominal, np.array([0.6 * np.pi, 0.0, 0.0]))
    rows = found.moves[:, 0]
    assert rows.mean() > 0.8
    columns = [DRIVE_COLUMNS.index(name) for name in ("coulomb", "viscous", "offset")]
    *_, offset = np.linalg.lstsq(found.drives[rows, 0][:, columns], found.torque[rows, 0])[0]
    assert abs(offset) < 0.01 * FRICTION
