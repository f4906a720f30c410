"""The laws of the actuators in NumPy, each beside its equation; the engine plugin agrees with them to 1e-9.

Nothing here needs MuJoCo. Fields of the dataclasses are the attributes of the plugins in the MJCF, with the same names,
units and defaults; values are checked when a model with them is compiled. Equation numbers are those of the paper.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import lru_cache
from itertools import accumulate
from math import isnan, nan
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

ROLLING_POWER = 2 / 3  # Palmgren, 1959: of speed, with which friction of lubricated rolling contacts grows
BALANCER_HARMONICS = (1, 2, 3)  # of the angle; the fourth would be a third of the third at most
SMALLEST_GAP = 1e-3  # least l_c - l as a part of l_c: a longer tendon would have pressed the gas into nothing


def balancer_waves(angle: ArrayLike) -> Array:
    """Return what the torque of a spring on a lever is linear in: sin q, cos q, sin 2q and so on, shape (..., 6).

    Hooked to the link at a from the joint's axis and to the frame before it at b, the spring has the length

        L = sqrt(a^2 + b^2 + 2 a b cos(q - q0))   and needs the torque   -(F_0 + k (L - L_0)) a b sin(q - q0) / L

    of the drive (law of cosines). Of a spring whose force is k L (free length zero) that is exactly A sin q + B cos q.
    Else 1 / L adds harmonics, each smaller than the one before, of which the second and third are taken too. (At
    b / a = 1/3 each is a fifth to a third of the one before.)

    Args:
        angle: Of the joint [rad].
    """
    waves = [wave(k * np.asarray(angle)) for k in BALANCER_HARMONICS for wave in (np.sin, np.cos)]
    return np.stack(waves, axis=-1)


def return_map(
    force: ArrayLike, dx: ArrayLike, sigma: ArrayLike, level_minus: ArrayLike, level_plus: ArrayLike
) -> Array:
    """Return the force of an elasto-plastic element after a displacement.

        f' = min(max(f - sigma dx, -level_plus), level_minus)

    Below the level the element is a spring, so it holds without creep; at the level it slips. All arguments broadcast.

    Args:
        force: Force before [N] or [Nm], positive along x.
        dx: Displacement [m] or [rad].
        sigma: Presliding stiffness [N/m] or [Nm/rad].
        level_minus: Greatest force against motion towards -x, >= 0.
        level_plus: Greatest force against motion towards +x, >= 0.
    """
    trial = np.asarray(force) - np.asarray(sigma) * np.asarray(dx)
    return np.asarray(np.minimum(np.maximum(trial, -np.asarray(level_plus)), level_minus), dtype=float)


def hold(x: ArrayLike, sigma: float, level_minus: ArrayLike, level_plus: ArrayLike, force: float = 0.0) -> Array:
    """Return the force of an elasto-plastic element along a path, shape (n,).

    Args:
        x: Positions, shape (n,) [m] or [rad].
        sigma: Presliding stiffness [N/m] or [Nm/rad].
        level_minus: Level at each position against motion towards -x, shape (n,) or scalar.
        level_plus: Level at each position against motion towards +x, shape (n,) or scalar.
        force: Force that is held on arrival at x[0].
    """
    x = np.asarray(x, dtype=float)
    minus, plus = np.broadcast_to(level_minus, x.shape), np.broadcast_to(level_plus, x.shape)
    forces = np.empty_like(x)
    for i, dx in enumerate(np.diff(x, prepend=x[:1])):
        forces[i] = force = float(return_map(force, dx, sigma, minus[i], plus[i]))
    return forces


@dataclass(frozen=True, kw_only=True)
class GasSpring:
    """Parameters of `bench.gas_spring`, a hydropneumatic cylinder that pulls along a tendon of length l.

    Attributes:
        constant: C of Eq. (8) [Nm].
        critical_length: l_c of Eq. (7), the length at which the gas volume would be zero [m].
        exponent: Polytropic exponent n; 1 is Eq. (8).
        reference_length: l_r, the length at which the exponent changes nothing [m].
        gas_amount: Amount of gas times its temperature, relative to what C stands for.
        heat_capacity_ratio: gamma, ratio of the heat capacities; 1 keeps the gas at ambient temperature.
        relaxation_time: tau, time in which a temperature difference falls to 1/e [s].
        seal_friction: Friction of the seals as a part of the gas force.
        seal_presliding: Presliding stiffness of the seals [N/m].
    """

    constant: float
    critical_length: float
    exponent: float = 1.0
    reference_length: float = nan
    gas_amount: float = 1.0
    heat_capacity_ratio: float = 1.0
    relaxation_time: float = nan
    seal_friction: float = 0.0
    seal_presliding: float = nan

    def gap(self, length: ArrayLike) -> Array:
        """Return l_c - l [m], which is the gas volume per area, kept above `SMALLEST_GAP` * l_c."""
        gap = self.critical_length - np.asarray(length, dtype=float)
        return np.asarray(np.maximum(gap, SMALLEST_GAP * self.critical_length))

    def gas_force(self, length: ArrayLike, temperature_rise: ArrayLike = 0.0) -> Array:
        """Return the pull of the gas [N]. For n = 1 and y = 1 this is Eq. (8), F = C / (l_c - l).

            F = gas_amount y C / (l_c - l_r) ((l_c - l_r) / (l_c - l))^n,    y = T / T0

        Args:
            length: l [m].
            temperature_rise: y - 1.
        """
        gap = self.gap(length)
        pull: Array = self.gas_amount * self.constant / gap * (1 + np.asarray(temperature_rise))
        if self.exponent != 1:
            pull *= ((self.critical_length - self.reference_length) / gap) ** (self.exponent - 1)
        return pull

    def temperature_rise(self, length: ArrayLike, dt: ArrayLike, rise: float = 0.0) -> Array:
        """Return y - 1 along a path, y = T / T0, shape (n,).

        First law for a closed ideal gas of volume V that exchanges heat with surroundings at T0, V ~ l_c - l:

            y' = -(gamma - 1) y V'/V - (y - 1) / tau

        solved exactly over each step for a constant V'/V, with c = -(gamma - 1) ln(V_new / V_old):

            y_new - 1 = (y - 1) exp(-z) + c (1 - exp(-z)) / z,    z = dt / tau - c

        Args:
            length: l at each step, shape (n,) [m].
            dt: Time step [s], or one before each instant but the first, shape (n - 1,).
            rise: y - 1 on arrival at length[0].
        """
        volume = self.gap(length)
        if self.heat_capacity_ratio == 1:
            return np.full(volume.shape, rise)
        compression = (self.heat_capacity_ratio - 1) * np.log(volume[:-1] / volume[1:])
        decay = np.asarray(dt) / self.relaxation_time - compression
        gain = np.divide(-np.expm1(-decay), decay, out=np.ones_like(decay), where=decay != 0)
        steps = zip(np.exp(-decay).tolist(), (compression * gain).tolist(), strict=True)
        return np.array([*accumulate(steps, lambda before, step: before * step[0] + step[1], initial=rise)])

    def force(self, length: ArrayLike, dt: float) -> Array:
        """Return the actuator force along a path from rest, shape (n,) [N]: seal friction less the pull of the gas."""
        pull = self.gas_force(length, self.temperature_rise(length, dt))
        if self.seal_friction == 0:
            return -pull
        level = self.seal_friction * pull
        return hold(length, self.seal_presliding, level, level) - pull


@dataclass(frozen=True, kw_only=True)
class Friction:
    """Parameters of `bench.friction`, an elasto-plastic element on a joint at position x and speed v.

    Attributes:
        coulomb: Level of sliding friction [Nm].
        presliding_stiffness: Stiffness below the level [Nm/rad].
        static_rise: Rise of the level at standstill, relative.
        stribeck_velocity: Speed at which the rise has fallen to 1/e [rad/s].
        asymmetry: Relative surplus of the level in + direction, deficit in - direction.
        viscous_asymmetry: More of the level per speed in + direction, less in - direction [Nm s/rad].
        rolling: More of the level at 1 rad/s, growing with speed to the power 2/3 [Nm].
        rolling_asymmetry: Relative surplus of rolling in + direction, deficit in - direction.
        drag, drag_square, drag_cube: More of the level, times |v|, v^2 and |v|^3 [Nm] per power of [rad/s].
        drag_speed: Up to where these hold [rad/s]; beyond, it goes on as steep as it is there, and falls no further.
        load_coefficient: Level per transmitted torque.
        element: Name of the tendon whose spring transmits the torque.
        ripple: Relative amplitude of the level over the angle.
        ripple_period: [rad].
        ripple_phase: [rad].
    """

    coulomb: float
    presliding_stiffness: float
    static_rise: float = 0.0
    stribeck_velocity: float = nan
    asymmetry: float = 0.0
    viscous_asymmetry: float = 0.0
    rolling: float = 0.0
    rolling_asymmetry: float = 0.0
    drag: float = 0.0
    drag_square: float = 0.0
    drag_cube: float = 0.0
    drag_speed: float = nan
    load_coefficient: float = 0.0
    element: str = ""
    ripple: float = 0.0
    ripple_period: float = nan
    ripple_phase: float = 0.0

    def levels(self, x: ArrayLike, v: ArrayLike, load: ArrayLike = 0.0) -> tuple[Array, Array]:
        """Return the levels [Nm] against motion towards - and +.

            coulomb (1 -+ asymmetry) (1 + static_rise exp(-(v / v_s)^2)) (1 + ripple sin(2 pi x / period + phase))
            + load_coefficient |load| + rolling (1 -+ rolling_asymmetry) |v|^(2/3)
            + drag_at(|v|), at least 0
            + viscous_asymmetry v, that of the direction of motion, at least 0

        Args:
            x: Position [rad].
            v: Velocity [rad/s].
            load: Transmitted torque [Nm].
        """
        coulomb = np.full(np.shape(x), self.coulomb)
        if self.static_rise > 0:
            with np.errstate(under="ignore"):
                coulomb *= 1 + self.static_rise * np.exp(-((np.asarray(v) / self.stribeck_velocity) ** 2))
        if self.ripple > 0:
            coulomb *= 1 + self.ripple * np.sin(2 * np.pi * np.asarray(x) / self.ripple_period + self.ripple_phase)
        more, rolling = self.load_coefficient * np.abs(load), self.rolling * np.abs(v) ** ROLLING_POWER
        minus, plus = (
            coulomb * (1 + way * self.asymmetry) + rolling * (1 + way * self.rolling_asymmetry) + more
            for way in (-1, 1)
        )
        if self.drag or self.drag_square or self.drag_cube:
            drag = self.drag_at(np.abs(v))
            minus, plus = np.maximum(minus + drag, 0), np.maximum(plus + drag, 0)
        uneven = self.viscous_asymmetry * np.asarray(v, dtype=float)
        forward = np.asarray(v) > 0
        minus = np.where(forward, minus, np.maximum(minus + uneven, 0))
        plus = np.where(forward, np.maximum(plus + uneven, 0), plus)
        return minus, plus

    def drag_at(self, speed: ArrayLike) -> Array:
        """Return drag |v| + drag_square v^2 + drag_cube |v|^3 [Nm] at |v| [rad/s], same shape; see `drag_speed`."""
        top = np.minimum(speed, self.drag_speed)
        level = top * (self.drag + top * (self.drag_square + top * self.drag_cube))
        slope = self.drag + top * (2 * self.drag_square + top * 3 * self.drag_cube)
        return np.asarray(level + (speed - top) * np.maximum(slope, 0))

    def force(self, x: ArrayLike, v: ArrayLike, load: ArrayLike = 0.0) -> Array:
        """Return the friction torque along a path from an unstressed start, shape (n,) [Nm]."""
        return hold(x, self.presliding_stiffness, *self.levels(x, v, load))


@dataclass(frozen=True, kw_only=True)
class TorqueTable:
    """Parameters of `bench.torque_table`, a torque over angle and direction of motion.

    Attributes:
        angle_min: Angle of the first torque [rad].
        angle_max: Angle of the last torque [rad].
        forward: Torques at equally spaced angles that act in motion towards + [Nm].
        backward: Torques that act in motion towards -; nowhere below `forward` [Nm].
        presliding_stiffness: Stiffness while the direction turns [Nm/rad]; needed where the two differ.
    """

    angle_min: float
    angle_max: float
    forward: tuple[float, ...]
    backward: tuple[float, ...]
    presliding_stiffness: float = nan

    @classmethod
    def of(cls, torque: Callable[[Array], ArrayLike], angle_min: float, angle_max: float, count: int) -> Self:
        """Tabulate a conservative torque [Nm] given as a function of an array of angles [rad]."""
        torques = np.broadcast_to(torque(np.linspace(angle_min, angle_max, count)), count)
        values = tuple(float(value) for value in torques)
        return cls(angle_min=angle_min, angle_max=angle_max, forward=values, backward=values)

    def lookup(self, x: ArrayLike) -> tuple[Array, Array]:
        """Return the conservative torque and the friction level at x [Nm]: mean and half difference of both directions.

        Linear between the angles of the table, constant beyond its ends.
        """
        angles = np.linspace(self.angle_min, self.angle_max, len(self.forward))
        place = np.asarray(x, dtype=float)
        forward, backward = np.interp(place, angles, self.forward), np.interp(place, angles, self.backward)
        return (forward + backward) / 2, (backward - forward) / 2

    def force(self, x: ArrayLike) -> Array:
        """Return the torque along a path from a start with unstressed friction, shape (n,) [Nm]."""
        mean, level = self.lookup(x)
        if isnan(self.presliding_stiffness):
            return mean
        return mean + hold(x, self.presliding_stiffness, level, level)


def config(law: GasSpring | Friction | TorqueTable) -> dict[str, str]:
    """Return the attributes of a law as MJCF text, numbers to full precision; what is not set is left out."""
    values = {field.name: getattr(law, field.name) for field in fields(law)}
    return {name: _text(value) for name, value in values.items() if value == value and value != ""}


@lru_cache(maxsize=64)  # fits add a table with the same numbers to model after model
def _text(value: float | str | tuple[float, ...]) -> str:
    if isinstance(value, str):
        return value
    return " ".join(repr(float(number)) for number in (value if isinstance(value, tuple) else (value,)))
