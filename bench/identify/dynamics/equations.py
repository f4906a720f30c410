"""The linear equations of a stretch of motion, model and data through the same filter.

    tau = Y(q, v, a) pi + J_r a + (F_c + F_v |v| + F_r |v|^(2/3) + F_l |t|) sign(v) + F_p (z - sign(v))
          + F_d |v| - r h F + c q + B w(q) + offset + g M(q) + S x + l (G(q) pi + G_f(q) m) - J_f^T W

for each drive: pi inertial parameters of the links, J_r rotor inertia, F_c Coulomb and F_v viscous friction, F_d half
the difference of viscous friction between the directions (that of Coulomb friction cannot be told from the offset),
F_r rolling friction of lubricated bearings (`bench/actuators/README.md`), which bends over speed, F_l friction that
grows with the torque t that the gear passes on (`gear_load.py`), c the stiffness of a dress pack, B w(q) a balancer
(`balancer.py`), F_p friction that turns late and z the share of it that there is (`presliding.py`), r the share of all
friction F that it loses in an hour, h hours after the middle of its recording (`falling_friction.py`), g the gas of the
counterbalance with its nominal torque M, x how much softer gears are than stated and S what their winding adds
(`bending.py`), l how far gravity leans and G what links weigh across it, G_f known masses m (`leaning.py`), W the known
load.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.actuators.laws import ROLLING_POWER
from bench.identify.arm import Arm
from bench.identify.dynamics.balancer import balancer_columns
from bench.identify.dynamics.band import Band
from bench.identify.dynamics.regressor import link_regressor, payload_columns
from bench.identify.dynamics.samples import MotionSamples
from bench.record.campaign import Array
from bench.record.moving import TRAVELS, TURNING
from bench.robot.counterbalance import Counterbalance
from bench.robot.nominal_dynamics import NominalDynamics

DRIVE_COLUMNS = (
    "rotor",
    "coulomb",
    "viscous",
    "viscous_difference",
    "rolling",
    "load",
    "spring",
    "balancer_sin",
    "balancer_cos",
    "balancer_sin_2",
    "balancer_cos_2",
    "balancer_sin_3",
    "balancer_cos_3",
    "warming",
    "presliding",
    "offset",
)
BALANCER = tuple(name for name in DRIVE_COLUMNS if name.startswith("balancer"))  # a spring on a lever (`balancer.py`)
# what a drive has where evidence and held-out errors want it
OPTIONAL = ("viscous_difference", "rolling", "load", "spring", "balancer", "warming", "presliding")
GAS_SHAPE = ("critical_length", "dead_centre", "rho", "b")  # of `Counterbalance`
# assumed: share of what a thinned sample is made of in which a joint has to move; half blurs the turns in
MOSTLY = 0.8


@dataclass(frozen=True)
class Equations:
    """Thinned equations of one stretch; T instants, n drives.

    Attributes:
        samples: The stretch.
        time: Shape (T,) [s].
        position: Shape (T, n), filtered.
        links: Shape (T, n, 10 n), factors of the links' inertial parameters.
        drives: Shape (T, n, 16), factors of `DRIVE_COLUMNS`, each of its own drive only; zero for "load" until there
            are links whose torque gears pass on (`gear_load.py`), for "warming" until there is friction that falls
            (`falling_friction.py`), for "presliding" until there is a travel over which friction turns
            (`presliding.py`), and for balancers of slides.
        gas: Shape (T, 1 + 4), motor torque against the nominal gas, and its derivatives by `GAS_SHAPE`; zeros without a
            counterbalance.
        winding: Shape (T, n, n) [Nm], what the winding of each gear, stiff as stated, adds to each drive; zeros until
            there are links to wind it (`bending.py`).
        leaning: Shape (T, n, 2, 10 n + 1), what the links' inertial parameters, and the known mass, weigh if gravity
            points in either direction across the model's; (T, n, 0, 10 n + 1) where it does not lean (`leaning.py`).
        known: Shape (T, n) [Nm], torque that the known load needs.
        torque: Shape (T, n) [Nm], measured; nan where it was not read.
        moves: Shape (T, n) bool, drives that move and were read: the equations that are used.
    """

    samples: MotionSamples
    time: Array
    position: Array
    links: Array
    drives: Array
    gas: Array
    winding: Array
    leaning: Array
    known: Array
    torque: Array
    moves: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.time)


def equations_of(samples: MotionSamples, band: Band, arm: Arm, nominal: NominalDynamics, top: Array) -> Equations:
    """Return the equations of a stretch.

    Args:
        samples: The stretch.
        band: The filter.
        arm: The links.
        nominal: For counterbalance and load point.
        top: Shape (n,), top speed of each joint in the campaign.
    """
    position, velocity, acceleration = band.smooth(samples)
    count, n = position.shape
    kept = band.kept(samples)
    given = position, velocity, acceleration, np.zeros_like(velocity), np.sign(velocity)
    drives = drive_columns(*given, arm.bodies.is_hinge)
    moving = (np.abs(velocity) > TURNING * top) & (top > 0) & (np.ptp(position, axis=0) > TRAVELS)
    read = np.isfinite(samples.torque).all(axis=0)
    links = link_regressor(arm, position, velocity, acceleration).reshape(count, -1)
    live = np.any(links != 0, axis=0)
    thinned = np.zeros((len(kept), links.shape[1]))
    thinned[:, live] = band.filtered(links[:, live], samples)
    return Equations(
        samples=samples,
        time=samples.time[kept],
        position=position[kept],
        links=thinned.reshape(len(kept), n, links.shape[1] // n),  # a stretch may be too short for any instant
        drives=band.filtered(drives.reshape(count, -1), samples).reshape(len(kept), n, len(DRIVE_COLUMNS)),
        gas=band.filtered(_gas_columns(nominal.counterbalance, position), samples),
        winding=np.zeros((len(kept), n, n)),
        leaning=np.zeros((len(kept), n, 0, links.shape[1] // n + 1)),
        known=band.filtered(known_torque(arm, nominal, samples, (position, velocity, acceleration)), samples),
        torque=band.filtered(np.where(read, samples.torque, 0.0), samples) + np.where(read, 0.0, np.nan),
        moves=(band.filtered(moving.astype(np.float64), samples) > MOSTLY) & read,
    )


def drive_columns(
    position: Array, velocity: Array, acceleration: Array, passed: Array, turned: Array, hinges: NDArray[np.bool_]
) -> Array:
    """Return the factors of `DRIVE_COLUMNS` before the filter, shape (T, n, 16).

    Args:
        position: Shape (T, n).
        velocity: Shape (T, n).
        acceleration: Shape (T, n).
        passed: Shape (T, n) [Nm], torque that gears pass on.
        turned: Shape (T, n), share of its level that Coulomb friction has.
        hinges: Shape (n,), joints that turn.
    """
    way, speed = np.sign(velocity), np.abs(velocity)
    columns = {
        "rotor": acceleration,
        "coulomb": way,
        "viscous": velocity,
        "viscous_difference": speed,
        "rolling": way * speed**ROLLING_POWER,
        "load": way * np.abs(passed),
        "spring": position,
        **dict(zip(BALANCER, np.moveaxis(balancer_columns(position, hinges), 2, 0), strict=True)),
        "warming": np.zeros_like(velocity),
        "presliding": turned - way,
        "offset": np.ones_like(velocity),
    }
    return np.stack([columns[name] for name in DRIVE_COLUMNS], axis=2)


def _gas_columns(full: Counterbalance | None, position: Array) -> Array:
    if full is None:
        return np.zeros((len(position), 1 + len(GAS_SHAPE)))
    theta, columns = position[:, full.joint], []
    for name in GAS_SHAPE:
        value, step = getattr(full, name), 1e-5  # [m] or [rad]; central differences are right to 1e-9 of the torque
        ahead, back = (replace(full, **{name: value + way * step}).torque(theta) for way in (1, -1))
        columns.append((ahead - back) / (2 * step))
    return np.stack([full.torque(theta), *columns], axis=1)


def known_torque(
    arm: Arm,
    nominal: NominalDynamics,
    samples: MotionSamples,
    state: tuple[Array, Array, Array],
    rows: NDArray[np.int64] | slice = slice(None),
) -> Array:
    """Return the motor torque that carries and accelerates the known load, shape (R, n) [Nm].

    Args:
        arm: The links.
        nominal: For the load point.
        samples: Which load there is.
        state: Position, velocity and acceleration at some of the samples, shape (R, n) each.
        rows: Which samples.
    """
    position, velocity, acceleration = state
    wrench, mass = samples.wrench[rows], samples.load_mass[rows]
    torque = np.zeros_like(position)
    loaded = wrench.any(axis=1)
    if loaded.any():
        jacobian = arm.jacobian(position[loaded], nominal.load_point)
        torque[loaded] = -np.einsum("tkj,tk->tj", jacobian, wrench[loaded])
    bolted = mass != 0
    if bolted.any():
        body, columns = payload_columns(arm, nominal.load_point)
        first = slice(10 * body, 10 * body + 10)
        moves = position[bolted], velocity[bolted], acceleration[bolted]
        still = position[bolted], 0 * velocity[bolted], 0 * acceleration[bolted]
        moving = (link_regressor(arm, *moves) - link_regressor(arm, *still))[:, :, first]
        torque[bolted] += moving @ columns[:, 0] * mass[bolted, None]
    return torque
