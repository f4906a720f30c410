"""What the gas of a hydropneumatic counterbalance does besides F = C / (l_c - l)."""

from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.conditions import REFERENCE_K, Conditions
from bench.effects.effect import WHOLE, Effect, Parameter, Place, Values
from bench.effects.geometry_at_zero import length_at_zero
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.robot.plugins import attributes_of, configure, number_of
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace

SEAL_TRAVEL = 5e-5  # assumed: [m], travel in which the seals' friction builds up, below a tenth of a millimetre


class OfGas(Effect):
    """An effect in the counterbalance."""

    family = "gas and cylinder"

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the robot if it has a cylinder at work."""
        return (WHOLE,) if compiled.counterbalance else ()


class PolytropicExponent(OfGas):
    """The gas is neither isothermal nor ideal."""

    name = "polytropic_exponent"
    title = "polytropic exponent of the gas"
    physics = (
        "Between slow (isothermal, n = 1) and fast (adiabatic) strokes p V^n stays constant, so the pull is "
        "F = C/(l_c - l_r) ((l_c - l_r)/(l_c - l))^n; with l_r, the length with all joints at zero, n bends the curve "
        "and leaves its level there."
    )
    source = "Pourmovahed and Otis, An experimental thermal time-constant correlation for hydraulic accumulators, 1990"
    parameters = (Parameter("exponent", "", 1.0, 0.03, 0.6, "n; 1.4 is adiabatic nitrogen at low pressure"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        exponent = values["exponent"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            actuator, tendon = _names(robot)
            reference = length_at_zero(spec, tendon)
            there = _given(spec, actuator, "exponent", 1.0)
            configure(spec, actuator, exponent=there + exponent - 1, reference_length=reference)

        return change if exponent != 1 else None


class GasLoss(OfGas):
    """Gas has leaked out."""

    name = "gas_loss"
    title = "loss of gas"
    between = "drifts"
    physics = (
        "Gas leaks through seals and valve over months; with a share x lost, F falls to (1 - x) F at every length."
    )
    source = "range: usual service limits of nitrogen accumulators (refill below 70 to 90 % of the charge); assumed"
    parameters = (Parameter("lost", "", 0.0, 0.01, 0.3, "share of the charge that is gone", most=1.0),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        return amount_scaled(1 - values["lost"])

    def there_already(self, compiled: CompiledRobot, place: Place) -> Mapping[str, float]:
        """Return that any loss may be made good: a cylinder is filled again, whatever the model has of it."""
        return {"lost": np.inf}


class GasTemperature(OfGas):
    """The gas is warmer or colder than the nominal figures say."""

    name = "gas_temperature"
    title = "gas warmer or colder than nominal"
    between = "anew"
    physics = "At the same volume p ~ T: F grows by the factor 1 + dT / 293.15 K (0.34 % per kelvin)."
    source = (
        "ideal gas law; range: workshop 5 to 45 degC and self-heating, assumed; never beyond -40 to 120 degC, which "
        "seals of accumulators bear (data sheets of NBR, ECO and FKM)"
    )
    parameters = (
        Parameter("offset", "K", 0.0, 3.0, 40.0, "gas temperature less 293.15 K", signed=True, least=-60.0, most=100.0),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        return amount_scaled(1 + values["offset"] / REFERENCE_K)

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return replace(reading, gas_temperature=reading.gas_temperature + values["offset"])


class ThermalRelaxation(OfGas):
    """Compression heats the gas, and the heat flows off."""

    name = "thermal_relaxation"
    title = "thermal relaxation of the gas"
    physics = (
        "Compression heats the gas and the heat leaves with a time constant: "
        "y' = -(gamma - 1) y V'/V - (y - 1)/tau with y = T/T0, F ~ y; so the pull depends on how fast and how long ago."
    )
    source = (
        "Otis and Pourmovahed, An algorithm for computing nonflow gas processes in gas springs and "
        "hydropneumatic accumulators, 1985"
    )
    parameters = (
        Parameter("gamma_excess", "", 0.0, 0.05, 0.6, "gamma - 1; 0.4 for nitrogen at low pressure"),
        Parameter("relaxation_time", "s", 30.0, 5.0, 120.0, "tau", is_shape=True),
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        excess, tau = values["gamma_excess"], values["relaxation_time"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            actuator, _ = _names(robot)
            there = _given(spec, actuator, "heat_capacity_ratio", 1.0)
            configure(spec, actuator, heat_capacity_ratio=there + excess, relaxation_time=tau)

        return change if excess else None


class SealFriction(OfGas):
    """The seals of the cylinder rub."""

    name = "seal_friction"
    title = "friction of the cylinder's seals"
    physics = (
        "Pressed by the pressure, the seals rub in proportion to it: the rod force differs between out and in by "
        "2 s F; they hold within 0.05 mm of travel."
    )
    source = (
        "range: design of this project, 1 to 8 %; form: contact pressure of the lips follows the gas pressure, assumed"
    )
    parameters = (Parameter("share", "", 0.0, 0.01, 0.08, "friction as a part of the gas force"),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        share = values["share"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            actuator, tendon = _names(robot)
            gap = number_of(spec, actuator, "critical_length") - length_at_zero(spec, tendon)
            pull = number_of(spec, actuator, "constant") / gap
            both = _given(spec, actuator, "seal_friction", 0.0) + share
            configure(spec, actuator, seal_friction=both, seal_presliding=both * pull / SEAL_TRAVEL)

        return change if share else None


class CounterbalanceGas(Effect):
    """A counterbalance that the nominal model leaves without gas."""

    name = "counterbalance_gas"
    family = "gas and cylinder"
    title = "counterbalance at work that the model leaves out"
    physics = (
        "The nominal cylinder pulls at nothing (gas_amount 0); the real one pulls with F = x C/(l_c - l), Eq. (8)."
    )
    source = "Eq. (8) of the paper; range: the stated C within a factor of three, assumed"
    parameters = (Parameter("gas_amount", "", 0.0, 0.3, 3.0, "relative to the charge that C stands for"),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        return (WHOLE,) if compiled.at.counterbalance >= 0 and compiled.counterbalance is None else ()

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        amount = values["gas_amount"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            configure(spec, _names(robot)[0], gas_amount=amount)

        return change if amount else None


def _names(robot: Robot) -> tuple[str, str]:
    """Return the names of the counterbalance's actuator and tendon."""
    balance = robot.figures.counterbalance
    assert balance
    return balance.actuator, balance.tendon


def _given(spec: mujoco.MjSpec, actuator: str, attribute: str, otherwise: float) -> float:
    """Return an attribute of the cylinder, which may be left out."""
    return float(attributes_of(spec, actuator).get(attribute, otherwise))


def amount_scaled(factor: float) -> SpecEdit | None:
    """Return a change of the amount of gas by a factor, None where that is one."""

    def change(spec: mujoco.MjSpec, robot: Robot) -> None:
        actuator, _ = _names(robot)
        configure(spec, actuator, gas_amount=factor * _given(spec, actuator, "gas_amount", 1.0))

    return change if factor != 1 else None
