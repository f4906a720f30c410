"""A spring on a lever about a joint, which carries a part of what its links weigh."""

import mujoco
import numpy as np

from bench.actuators.laws import TorqueTable
from bench.effects.conditions import Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.gear_kinematics import table_range
from bench.effects.places import OnDrive, hinges
from bench.effects.plugin_actuators import add_torque_table
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

KNOTS = 721  # rounding: half a degree apart over a turn, where a line misses the third harmonic by 0.01 %
_ALL = ((1, "", "", 1.0), (2, "_2", " 2", 0.5), (3, "_3", " 3", 0.25))  # harmonic, in names, in words, how large


def _sizes() -> tuple[Parameter, ...]:
    """Return six sizes: sine and cosine of each harmonic; each may be half as large as the one before."""
    return tuple(
        Parameter(
            f"{wave}{name}",
            "Nm",
            0.0,
            250.0 * share,
            5000.0 * share,
            f"times {wave}{words} theta; range for a drive of 10 kNm",
            signed=True,
        )
        for _, name, words, share in _ALL
        for wave in ("sin", "cos")
    )


class SpringBalancer(OnDrive):
    """A spring on a lever carries weight.

    Six sizes over the angle hold much of what other effects do there, so it is looked for only where a first pass over
    moving data has one, which weighs it against masses, friction and dress packs.
    """

    name = "spring_balancer"
    family = "geometry and mass"
    title = "spring balancer that the model leaves out"
    physics = (
        "A coil spring, hooked a from the axis and b on the frame before it, takes the torque "
        "(F_0 + k (L - L_0)) a b sin(theta - theta_0)/L from the drive, L^2 = a^2 + b^2 + 2 a b cos(theta - theta_0): "
        "a Fourier series whose terms fall fast, of which three are taken. Sizes are what the drive has more."
    )
    source = "law of cosines; range: up to half of the torque limit, assumed: it carries what links and payload weigh"
    parameters = _sizes()
    is_additive = True
    only_if_told = True
    advice = (
        "If the machine has a balancer, state its torque; if not, look for a counterweight, a cable or wrong masses."
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the drives that turn; a slide's balancer is a constant force, which is an offset of its torque."""
        return hinges(compiled)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        if not any(values[p.name] for p in self.parameters):
            return None

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            law = TorqueTable.of(lambda x: _torque(values, x), *table_range(spec, place.name), KNOTS)
            add_torque_table(spec, f"spring balancer {place.name}", law, joint=place.name)

        return change

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        return Torques(link=_torque(values, followed.trace.theta[:, place.index]))


def _torque(values: Values, angle: Array) -> Array:
    """Return the torque on the link [Nm] at angles [rad], of the same shape."""
    torque = np.zeros_like(angle)
    for k, name, _, _ in _ALL:
        torque -= values[f"sin{name}"] * np.sin(k * angle) + values[f"cos{name}"] * np.cos(k * angle)
    return torque
