"""A spring on a lever about a joint, which carries a part of what its links weigh."""

import mujoco
import numpy as np

from bench.actuators.laws import BALANCER_HARMONICS, TorqueTable, balancer_waves
from bench.effects.conditions import Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.followed import Followed, Torques
from bench.effects.gear_kinematics import table_range
from bench.effects.places import OnDrive, hinges
from bench.effects.plugin_actuators import add_torque_table
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

KNOTS = 721  # rounding: half a degree apart over a turn, where a line misses the third harmonic by 0.01 %


def _sizes() -> tuple[Parameter, ...]:
    """Return a size for each wave of `balancer_waves`; each harmonic may be half as large as the one before."""
    found = []
    for k in BALANCER_HARMONICS:
        name, words, share = ("", "theta", 1.0) if k == 1 else (f"_{k}", f"{k} theta", 0.5 ** (k - 1))
        for wave in ("sin", "cos"):
            said = f"times {wave} {words}; range for a drive of 10 kNm"
            found.append(Parameter(f"{wave}{name}", "Nm", 0.0, 250.0 * share, 5000.0 * share, said, signed=True))
    return tuple(found)


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
    advice = "If the machine has no balancer, look for a counterweight, a cable or masses that are far off."

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
    sizes = np.array([values[size.name] for size in SpringBalancer.parameters])
    return np.asarray(-balancer_waves(angle) @ sizes)
