"""The HH-150 from Table 1 and the reconstructed masses, as `RigidBodies` and as the counterbalance in closed form."""

import numpy as np

from bench.identify.denavit_hartenberg import Row, bodies_from_table
from bench.robot.bodies import RigidBodies
from bench.robot.counterbalance import Counterbalance

DEGREE = np.pi / 180
STIFFNESS = np.array([0.559e6, 1.435e6, 1.829e6, 0.184e6, 0.171e6, 0.070e6])  # [Nm/rad], Table 6, current
TORQUE_CONSTANT = np.array([169.6355, 220.8436, 220.8436, 127.0724, 138.3101, 139.4627])  # [Nm/A], Table 2
COUNTERBALANCE = Counterbalance(1, 0.70, 0.20, 3.3 * DEGREE, 4771.4, 0.9112)

POINTS = {
    "load": (0.15, 0.0, -0.45),
    "reflector_1": (0.25, 0.10, -0.45),
    "reflector_2": (-0.25, 0.10, -0.45),
    "reflector_3": (0.0, -0.30, -0.20),
}


def _row(a, alpha, d, zero, limits, mass, com, inertia):
    low, high = limits
    return Row(a, alpha * DEGREE, d, zero * DEGREE, (low * DEGREE, high * DEGREE), mass, com, inertia)


# a_{i-1} [m], alpha_{i-1} [deg], d_i [m], angle of the table at joint zero [deg], limits [deg], then
# mass [kg], centre of mass in frame i [m], inertia [kg m^2] (masses: reconstruction.md; inertias: of that order)
TABLE_1 = (
    _row(0.0, 0, 0.683, 0, (-185, 185), 355.0, (0.10, 0.0, -0.30), (30.0, 30.0, 20.0)),
    _row(0.35, -90, 0.0, -90, (-40, 110), 160.0, (0.50, 0.0, 0.0), (3.0, 25.0, 25.0)),
    _row(1.2, 0, 0.0, 180, (-190, 54), 110.0, (0.0, -0.30, 0.0), (6.0, 2.0, 6.0)),
    _row(0.0, -90, -1.049, 0, (-350, 350), 40.0, (0.0, 0.0, 0.349), (2.0, 2.0, 0.5)),
    _row(0.0, 90, 0.0, 0, (-120, 120), 25.0, (0.0, -0.05, 0.0), (0.3, 0.3, 0.3)),
    _row(0.0, -90, 0.0, 0, (-350, 350), 48.0, (0.0, 0.0, -0.367), (1.5, 1.5, 0.8)),
)


def hh150() -> RigidBodies:
    return bodies_from_table(TABLE_1, POINTS)
