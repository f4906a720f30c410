"""How much an instrument would scatter that a campaign has not."""

import numpy as np

from bench.diagnose.replay.noise import (
    LINK_ENCODER,
    UNIFORM,
    UNSTATED_CURRENT,
    UNSTATED_FORCE,
    UNSTATED_M,
    torque_sigma,
)
from bench.diagnose.replay.quantities import Quantity
from bench.robot.compiled import CompiledRobot

RING = 5e-6  # assumed: [rad] or [m], error of an encoder that is put onto a link: an arcsecond


def noise_of_new(quantity: Quantity, compiled: CompiledRobot) -> float:
    """Return the noise of one reading of an instrument that is not there, in its unit; inf of what nobody can add.

    It is that of the robot's figures, and where these have none, what a diagnosis takes once there are readings of it.

    Args:
        quantity: What it would read.
        compiled: The nominal robot.
    """
    fitted = compiled.robot.figures.instruments
    match quantity.kind:
        case "current":
            if fitted.torque and not fitted.current:
                constant = abs(float(compiled.torque_constant[quantity.index]))
                return torque_sigma(fitted.torque, quantity.index) / constant
            return (fitted.current or UNSTATED_CURRENT).sigma_a
        case "reflector":
            far = float(np.linalg.norm(fitted.tracker.position_m)) if fitted.tracker else 0.0
            return fitted.tracker.sigma_per_distance * far if fitted.tracker and far else UNSTATED_M
        case "q_link":
            stated = fitted.link_encoder.accuracy_rad if fitted.link_encoder else 0.0
            return float(np.hypot(LINK_ENCODER, stated or RING))
        case "force":
            return (fitted.force or UNSTATED_FORCE).sigma_n
        case "moment":
            return (fitted.force or UNSTATED_FORCE).sigma_nm
        case _:
            return float(UNIFORM * fitted.pressure.resolution_pa) if fitted.pressure else np.inf
