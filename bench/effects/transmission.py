"""Elasticity and play of a drive's transmission."""

from collections.abc import Mapping

import mujoco
import numpy as np

from bench.actuators.laws import Friction, TorqueTable
from bench.effects.conditions import REFERENCE_K, Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.places import OnDrive, drive_of
from bench.effects.plugin_actuators import add_friction, add_torque_table
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.robot.patching.numbers import UNSET_LENGTH

STIFFEST = 0.1  # rounding: of the compliance as stated: however far a fit tries, a gear that gives stays one
SATURATED = 8.0  # rounding: tanh(8) is 1 - 2e-7: a table that ends there ends level
KNOTS = 241  # rounding: 15 per knee: linear in between is right to 6e-4 of the torque that the softening takes off


class _InElement(OnDrive):
    family = "transmission"


class JointCompliance(_InElement):
    """The elastic element is softer or stiffer than its figure."""

    name = "joint_compliance"
    title = "compliance of the elastic element"
    physics = (
        "The gear, its bearings and shafts give by tau (1 + x)/k instead of tau/k, over the whole range of torque."
    )
    source = "Spong, Modeling and control of elastic joint robots, 1987; range: catalogue against measured, assumed"
    parameters = (Parameter("change", "", 0.0, 0.1, 0.6, "of the compliance, relative", signed=True, least=-0.9),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]

        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            tendon = spec.tendon(drive_of(robot, place).element)
            tendon.stiffness = np.asarray(tendon.stiffness) / (1 + change)

        return edit if change else None


class ComplianceTemperature(_InElement):
    """The elastic element gives more, or less, as the gearbox warms up."""

    name = "compliance_temperature"
    title = "stiffness depends on gear temperature"
    physics = (
        "Housing, bearings and gear expand by different amounts, so preload changes with the temperature: the elastic "
        "element gives by tau (1 + c (T_gear - 293.15 K))/k."
    )
    source = "preload of bearings and gears over temperature; range: 0.1 to 2 %/K, assumed"
    parameters = (
        Parameter("growth", "1/K", 0.0, 1e-3, 2e-2, "c, of the compliance per kelvin, relative", signed=True),
    )
    needs = ("gear_temperature",)
    depends_on_conditions = True

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["growth"] * float(conditions.gear_k[place.index] - REFERENCE_K)

        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            tendon = spec.tendon(drive_of(robot, place).element)
            tendon.stiffness = np.asarray(tendon.stiffness) / max(1 + change, STIFFEST)

        return edit if change else None


class Softening(_InElement):
    """The gear is soft as long as it transmits little."""

    name = "softening"
    title = "softening at low torque"
    physics = (
        "At low torque few teeth and rollers carry: tau(x) = k x - s k x_s tanh(x/x_s) for a torsion x, so the "
        "slope is "
        "(1 - s) k about zero and k beyond the knee tau_s = k x_s. A torque table along the elastic element."
    )
    source = (
        "Harmonic Drive catalogues (three-step torsional stiffness K1 < K2 < K3); "
        "Kircanski and Goldenberg, An experimental study of nonlinear stiffness, hysteresis, and friction "
        "effects in robot joints with harmonic drives, 1997; range: design of this project, k_low/k 0.3 to 0.8"
    )
    parameters = (
        Parameter("softness", "", 0.0, 0.2, 0.7, "s = 1 - k_low/k", most=1.0),
        Parameter("knee", "", 0.1, 0.02, 0.4, "tau_s, as a part of the drive's torque limit", is_shape=True),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        softness, knee = values["softness"], values["knee"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            stiffness = float(np.asarray(spec.tendon(drive.element).stiffness)[0])
            torsion = knee * limit_in(spec, robot, place) / stiffness

            def relief(x: Array) -> Array:
                return softness * stiffness * torsion * np.tanh(x / torsion)

            law = TorqueTable.of(relief, -SATURATED * torsion, SATURATED * torsion, KNOTS)
            add_torque_table(spec, f"softening {drive.element}", law, tendon=drive.element)

        return change if softness else None


class Backlash(_InElement):
    """The gear has play."""

    name = "backlash"
    title = "backlash"
    physics = (
        "Within a gap g between the flanks nothing is transmitted: tau = k (x - g/2 sign x) for |x| > g/2, else 0."
    )
    source = (
        "Nordin and Gutman, Controlling mechanical systems with backlash: a survey, 2002; range: design of this project"
    )
    parameters = (Parameter("gap", "rad", 0.0, 2.9e-5, 4.4e-4, "g at the joint; 0.1 to 1.5 arcmin"),)
    scatters = True

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        gap = values["gap"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            tendon = spec.tendon(drive_of(robot, place).element)
            lengths = np.asarray(tendon.springlength)
            rest = np.where(lengths == UNSET_LENGTH, 0.0, lengths)  # where q = theta it is 0
            tendon.springlength = rest + np.array([-gap / 2, gap / 2])

        return change if gap else None

    def there_already(self, compiled: CompiledRobot, place: Place) -> Mapping[str, float]:
        """Return the gap that a model has already."""
        return {"gap": float(compiled.play[place.index])}


class Hysteresis(_InElement):
    """Torsion lags behind torque."""

    name = "hysteresis"
    title = "hysteresis of the transmission"
    physics = (
        "Micro-slip between flanks, pins and bearing rings: an elasto-plastic element of level h beside the "
        "spring. The "
        "branches of torque over torsion lie 2 h apart; the torsion's lost motion is 2 h/k."
    )
    source = (
        "Ruderman, Hoffmann and Bertram, Modeling and identification of elastic robot joints with hysteresis and "
        "backlash, 2009; range: 0.1 to 3 % of the torque limit, assumed"
    )
    parameters = (
        Parameter("level", "Nm", 0.0, 10.0, 300.0, "h; range for a drive of 10 kNm"),
        Parameter("slip", "rad", 1e-4, 3e-5, 5e-4, "torsion after which it slips; at least h/k", is_shape=True),
    )
    holds = "level"

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        level, slip = values["level"], values["slip"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            element = drive_of(robot, place).element
            stiffness = float(np.asarray(spec.tendon(element).stiffness)[0])
            law = Friction(coulomb=level, presliding_stiffness=min(level / slip, stiffness))
            add_friction(spec, f"hysteresis {element}", law, tendon=element)

        return change if level else None


def limit_in(spec: mujoco.MjSpec, robot: Robot, place: Place) -> float:
    """Return the torque limit of a drive in a spec [Nm]; of an unlimited servo a guess from the rating."""
    low, high = spec.actuator(drive_of(robot, place).servo).forcerange
    return float(max(-low, high)) or robot.figures.rating.force_n
