"""What is allowed to be a little wrong: nominal figures of the robot and errors of its instruments, each with a prior.

What these can explain within their stated uncertainty is not a discovery.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bench.diagnose.replay.noise import GAS_DRIFT_K
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.reading_errors import (
    OnReading,
    current_gain,
    current_offset,
    force_gain,
    force_tilt,
    frame_drift,
    frame_shift,
    frame_turn,
    link_zero,
    nest_shift,
    thermometer_zero,
    torque_gain,
    torque_offset,
)
from bench.effects.drifts import BETWEEN, DAY_K, VISCOUS, own_part
from bench.effects.effect import IN_RECORDING, Between
from bench.effects.geometry import JointZero
from bench.effects.nominal import factor_of, nominal_parameters, presliding_parameters
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.turned_sites import TurnedSites
from bench.simulate.pulls import pulled

# assumed: [K], of a thermometer on the cylinder's wall, and of the temperature at which the figures hold
THERMOMETER_K = 2.0
THERMOMETER = "thermometer of the gas"
# derived: [rad] or [m], how well secondary encoders are zeroed where the figures do not say: as the catalogue expects
# of motor encoders
UNKNOWN_ZERO = JointZero.parameters[0].sigma

MOTOR_ZERO = "zero of the motor encoder of "
PULLED = "loads pulled aside"
PULL_DIRECTION = "direction of loads pulled aside, "


@dataclass(frozen=True)
class Earlier:
    """What an earlier diagnosis left of something that may be off, in its unit; the robot of this one has that.

    Attributes:
        found: What was found, less what is stated; of what is known to a factor, as a share.
        known: Standard deviation with which that was known of the recording in which it was found.
        expected: Standard deviation with which it is expected of the next recording, as far as it drifts.
        is_share: A deviation from it is a share of what was found.
    """

    found: float
    known: float
    expected: float
    is_share: bool

    def total(self, off: float) -> float:
        """Return what is found now, less what is stated, where that is `off` from what was found."""
        return self.found + off * (1 + self.found) if self.is_share else self.found + off


@dataclass(frozen=True, eq=False)
class Nuisance:
    """One thing that may be off; zero changes nothing.

    Attributes:
        name: For people.
        unit: "" for a relative deviation, or what is known to a factor.
        sigma: Standard deviation of its prior.
        is_factor: It is known to a factor (`effects/nominal.py`).
        least: Least deviation, in its unit.
        widened: Times that sigma is larger than what is stated of it.
        of_mass: It is the mass of a link, or where that sits.
        edit: How it changes the model, or None.
        on_reading: How it changes readings, or None.
        scales_wrench: It is the relative error of what hangs at the load point.
        scales_payload: It is the relative error of what is bolted to it.
        on_wrench: How it changes the loads on the load point, shape (T, 6) [N, Nm] in world axes, or None.
        encoder: It is by what the encoder of this motor reads too much, all the while; None: it is something else.
        between: What becomes of it between two recordings, as of an effect (`effects/effect.py`).
        own: Standard deviation of the part that is another one in each recording, in its unit; 0 of what is the same.
        recording: Name of the only recording in which it acts; None: in all.
        after_effects: It changes the model with all that was found in it, such as friction; else the nominal one.
        said_before: What each reading of an earlier diagnosis changes by with one unit of it (`given.py`).
        beside: Name of the effect without which it changes nothing; "": it always does.
        earlier: What that diagnosis left of it; None: there is none, or it says nothing of it.
    """

    name: str
    unit: str
    sigma: float
    edit: Callable[[float], SpecEdit] | None = None
    on_reading: OnReading | None = None
    scales_wrench: bool = False
    scales_payload: bool = False
    on_wrench: Callable[[float, Array], Array] | None = None
    encoder: int | None = None
    between: Between = "same"
    recording: str | None = None

    def __str__(self) -> str:
        return self.name if self.recording is None else f"{self.name}{IN_RECORDING}{self.recording}"

    said_before: tuple[float, ...] = ()
    earlier: Earlier | None = None
    own: float = 0.0
    is_factor: bool = False
    least: float = -np.inf
    widened: float = 1.0
    of_mass: bool = False
    after_effects: bool = False
    beside: str = ""

    @property
    def moves_robot(self) -> bool:
        """Whether a robot in which it is off moves differently, and has to be simulated anew."""
        changes = self.edit or self.on_wrench or self.scales_wrench or self.scales_payload
        return bool(changes) or self.encoder is not None

    @property
    def is_simulated(self) -> bool:
        """Whether it changes model or readings; if not (friction at rest, a single weight), it acts to first order."""
        return self.moves_robot or self.on_reading is not None

    @property
    def is_of_day(self) -> bool:
        """Whether it is the part that one recording has of what drifts, or its weather: the next has another one."""
        return self.recording is not None and (
            self.between == "drifts" or (self.between == "anew" and self.edit is not None)
        )

    def off_by(self, sigmas: float) -> float:
        """Return by how much something is off at so many standard deviations of its prior, in its unit."""
        deviation = sigmas * self.sigma
        return factor_of(deviation, self.sigma) - 1 if self.is_factor else max(deviation, self.least)

    @property
    def drifts_besides(self) -> bool:
        """Whether it is a figure of the robot whose drift is none of what is stated of it."""
        return self.edit is not None and self.own > 0

    @property
    def lasting(self) -> float:
        """Standard deviation of what is the same in all recordings, in its unit.

        What is stated of an instrument holds whenever it is read, so its drift is a part of that. A figure of the robot
        holds at one temperature, and its drift comes on top.
        """
        if self.recording is not None:
            return 0.0
        return self.sigma if self.edit else float(np.sqrt(max(self.sigma**2 - self.own**2, 0.0)))


def nuisances_of(compiled: CompiledRobot, quantities: tuple[Quantity, ...]) -> tuple[Nuisance, ...]:
    """Return everything that may be off in a robot and in the instruments that were there."""
    kinds = {quantity.kind for quantity in quantities}
    found = []
    for p in (*nominal_parameters(compiled), *presliding_parameters(compiled)):
        if p.seen_by and p.seen_by not in kinds:
            continue
        one = Nuisance(p.name, p.unit, p.sigma, edit=p.edit, is_factor=p.is_factor, least=p.least)
        one = replace(one, widened=p.widened, of_mass=p.of_mass, beside=p.beside)
        found.append(replace(one, between="drifts", own=VISCOUS * DAY_K) if p.is_viscous else one)
    load = compiled.robot.figures.uncertainty.load
    found.append(Nuisance("weights that hang", "", load, scales_wrench=True))
    found.append(Nuisance("weights bolted on", "", load, scales_payload=True, between="anew", own=load))
    found += (
        _pulls(compiled)
        + _motor_zeros(compiled)
        + _drives(compiled, kinds)
        + _tracker(compiled, quantities)
        + _force(compiled, kinds)
    )
    if "gas_temperature" in kinds:
        found.append(
            Nuisance(
                THERMOMETER,
                "K",
                THERMOMETER_K,
                on_reading=thermometer_zero,
                between="drifts",
                own=GAS_DRIFT_K,  # by which the gas differs from the wall: another one on another day
            )
        )
    if "q_link" in kinds:
        fitted = compiled.robot.figures.instruments.link_encoder
        sigma, zeroing = (fitted.offset_sigma_rad, fitted.zeroing_sigma_rad) if fitted else (UNKNOWN_ZERO, None)
        joints = [quantity.index for quantity in quantities if quantity.kind == "q_link"]
        zeros = [
            _error("link_encoder_offset", f"zero of link encoder {j + 1}", "rad", sigma, link_zero(j)) for j in joints
        ]
        found += zeros if zeroing is None else [replace(zero, own=min(zeroing, sigma)) for zero in zeros]
    return tuple(nuisance for nuisance in found if nuisance.sigma > 0)


def _pulls(compiled: CompiledRobot) -> list[Nuisance]:
    """Return size and direction of loads that are pulled aside, as well as they are stated."""
    known = compiled.robot.figures.uncertainty

    def error(name: str, unit: str, sigma: float, on_wrench: Callable[[float, Array], Array]) -> Nuisance:
        return Nuisance(name, unit, sigma, on_wrench=on_wrench, between="anew", own=sigma)

    return [
        error(PULLED, "", known.pull, lambda x, wrench: pulled(wrench, x, np.zeros(3))),
        *(
            error(f"{PULL_DIRECTION}{name}", "rad", known.pull_rad, partial(_turned, axis))
            for name, axis in zip("xyz", np.eye(3), strict=True)
        ),
    ]


def _turned(axis: Array, x: float, wrench: Array) -> Array:
    return pulled(wrench, 0.0, x * axis)


def _motor_zeros(compiled: CompiledRobot) -> list[Nuisance]:
    """Return the zeros of the motors' encoders, as well as they are stated; of a slide in m."""
    encoder = compiled.robot.figures.instruments.encoder
    sigma, zeroing = (encoder.offset_sigma_rad, encoder.zeroing_sigma_rad) if encoder else (0.0, 0.0)
    one = Nuisance(MOTOR_ZERO, "rad", sigma, between="drifts" if zeroing else "same", own=min(zeroing, sigma))
    joints = [drive.joint for drive in compiled.robot.figures.drives]
    return [replace(one, name=f"{MOTOR_ZERO}{joint}", encoder=j) for j, joint in enumerate(joints)]


def _drives(compiled: CompiledRobot, kinds: set[str]) -> list[Nuisance]:
    figures = compiled.robot.figures
    found = []
    current, torque = figures.instruments.current, figures.instruments.torque
    for j, drive in enumerate(figures.drives):
        if "current" in kinds:
            gain = float(np.hypot(drive.torque_constant_error, current.gain_sigma if current else 0.0))
            offset = current.offset_sigma_a if current else 0.0
            found += [
                _error("current_gain", f"torque constant of {drive.joint}", "", gain, current_gain(j)),
                _error("current_offset", f"current offset of {drive.joint}", "A", offset, current_offset(j)),
            ]
        if "tau_motor" in kinds:
            gain = torque.gain_sigma if torque else drive.torque_constant_error
            offset = torque.offset_sigma_of(compiled.n_joints)[j] if torque else 0.0
            found += [
                _error("torque_gain", f"torque constant of {drive.joint}", "", gain, torque_gain(j)),
                _error("torque_offset", f"torque offset of {drive.joint}", "Nm", offset, torque_offset(j)),
            ]
    return found


def _error(field: str, name: str, unit: str, sigma: float, on_reading: OnReading) -> Nuisance:
    """Return an error of an instrument, by its field of `SystematicErrors`."""
    return Nuisance(name, unit, sigma, on_reading=on_reading, between=BETWEEN[field], own=own_part(field, sigma))


def _tracker(compiled: CompiledRobot, quantities: tuple[Quantity, ...]) -> list[Nuisance]:
    tracker = compiled.robot.figures.instruments.tracker
    reflectors = sorted({quantity.index for quantity in quantities if quantity.kind == "reflector"})
    if tracker is None or not reflectors:
        return []
    found, nests, sites = [], tracker.placement_sigma_m, TurnedSites.reflectors_of(compiled)
    for axis, name in enumerate("xyz"):
        along = np.eye(3)[axis]
        found += [
            _error("frame_shift", f"tracker frame, shift {name}", "m", tracker.frame_sigma_m, frame_shift(along)),
            _error("frame_rotation", f"tracker frame, turn {name}", "rad", tracker.frame_sigma_rad, frame_turn(along)),
            _error("frame_drift", f"tracker drift {name}", "m/h", tracker.drift_m_per_h, frame_drift(along)),
        ]
        found += [
            _error("placement", f"nest of reflector {k + 1}, {name}", "m", nests, nest_shift(k, axis, sites))
            for k in reflectors
        ]
    return found


def _force(compiled: CompiledRobot, kinds: set[str]) -> list[Nuisance]:
    force = compiled.robot.figures.instruments.force
    if force is None or "force" not in kinds:
        return []
    tilt = force.direction_sigma_rad
    return [
        _error("force_gain", "gain of the force sensor", "", force.gain_sigma, force_gain),
        *(
            _error("force_tilt", f"tilt of the force sensor, {name}", "rad", tilt, force_tilt(np.eye(3)[i]))
            for i, name in enumerate("xyz")
        ),
    ]
