"""One drive along a path: what its friction elements remember, where its motor stands and where its link rests.

Every element is held as a force along its own coordinate. The elasto-plastic law is a return map, f = clip(f - sigma
dx, -level, level), exact over any step in one direction. Dahl's is f' = -sigma (1 + f/level sign(dx)) dx, whose exact
solution over a step tends to the level exponentially; with a Stribeck level it is the quasi-static part of LuGre.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, tanh

import numpy as np
from numpy.typing import NDArray

from bench.second.figures import Array, Law

ROUNDS = 60  # of a balance by regula falsi (Illinois); every fourth halves the bracket
SMALLEST = 1e-14  # [rad], of a bracket
NEWTON = 30  # steps to the torsion of a bent spring
TORQUE_TOLERANCE = 1e-6  # [Nm]; links need 10 to 10,000

Next = Callable[[float, float, float, float, float], float]


def held(force: float, dx: float, sigma: float, plus: float, minus: float) -> float:
    """Return an elasto-plastic element's force after a step; `plus` bounds it against motion towards +."""
    return min(max(force - sigma * dx, -plus), minus)


def dahl(force: float, dx: float, sigma: float, plus: float, minus: float) -> float:
    """Return the force of Dahl's element after a step in one direction."""
    level, way = (plus, dx) if dx > 0 else (-minus, -dx)  # the force tends to -level
    if level == 0 or dx == 0:
        return 0.0 if level == 0 else force
    return -level + (force + level) * exp(-min(sigma * way / abs(level), 700.0))


LAWS: dict[Law, Next] = {"elasto-plastic": held, "dahl": dahl}


@dataclass(frozen=True)
class Spring:
    """One elastic element; see `figures.Springs`."""

    stiffness: float
    softness: float
    knee: float
    gap: float

    def torque(self, torsion: float) -> float:
        """Return what it transmits [Nm]."""
        x = abs(torsion) - self.gap / 2
        if x <= 0:
            return 0.0
        if self.softness:
            bend = self.knee / self.stiffness
            x -= self.softness * bend * tanh(x / bend)
        return self.stiffness * x if torsion > 0 else -self.stiffness * x

    def torsion(self, torque: float) -> float:
        """Return the torsion under a torque [rad]; without torque it is in the middle of its play."""
        x = abs(torque) / self.stiffness
        if self.softness:
            bend = self.knee / self.stiffness
            for _ in range(NEWTON):
                ratio = tanh(x / bend)
                left = abs(torque) - self.stiffness * (x - self.softness * bend * ratio)
                if abs(left) < TORQUE_TOLERANCE:
                    break
                x += left / (self.stiffness * (1 - self.softness * (1 - ratio * ratio)))
        x += self.gap / 2 if torque else 0.0
        return x if torque >= 0 else -x


@dataclass(frozen=True, eq=False)
class Element:
    """A friction element along a path of T instants.

    Attributes:
        stiffness: Shape (T,), while it holds.
        plus, minus: Shape (T,), levels against motion towards + and -.
        drawn: Shape (T,), share of the level at which it is found when chance has moved it; nan: it remembers.
    """

    stiffness: Array
    plus: Array
    minus: Array
    drawn: Array


def link_path(
    spring: Spring, q: Array, asked: Array, elements: Sequence[Element], begins: NDArray[np.bool_], law: Law
) -> tuple[Array, Array]:
    """Return where a link rests, shape (T,) [rad], and the friction on it, shape (T, e) [Nm], e elements.

    Args:
        spring: Between motor and link.
        q: Shape (T,) [rad], of the motor.
        asked: Shape (T,) [Nm], what the link needs of spring and friction.
        elements: Friction on the link.
        begins: Shape (T,), instants at which nothing is remembered.
        law: Of friction.
    """
    rule = LAWS[law]
    is_plain = not spring.softness and not spring.gap and len(elements) == 1
    columns = [
        [values.tolist() for values in (e.stiffness, e.plus, e.minus, np.where(np.isnan(e.drawn), 2.0, e.drawn))]
        for e in elements
    ]
    motor, need, starts = q.tolist(), asked.tolist(), begins.tolist()
    rest, friction = np.empty(len(q)), np.empty((len(q), len(elements)))
    force, theta = [0.0] * len(elements), 0.0
    for t, where in enumerate(motor):
        now = [tuple(values[t] for values in column) for column in columns]
        if starts[t]:
            force = [0.0] * len(elements)
            theta = where - spring.torsion(need[t])
        elif all(abs(one[3]) <= 1 for one in now) and now:
            force = [-one[3] * (one[1] if one[3] > 0 else one[2]) for one in now]
            theta = where - spring.torsion(need[t] - sum(force))
        elif is_plain and law == "dahl":
            sigma, plus, minus, _ = now[0]
            theta, force[0] = _dahl_balance(spring.stiffness, where, need[t], theta, force[0], sigma, plus, minus)
        elif is_plain:
            sigma, plus, minus, _ = now[0]
            k = spring.stiffness
            stuck = (k * where - need[t] + force[0] + sigma * theta) / (k + sigma)
            force[0] = min(max(force[0] - sigma * (stuck - theta), -plus), minus)
            theta = where - (need[t] - force[0]) / k
        else:
            theta = _balance(spring, where, need[t], theta, force, now, rule)[0]
            before = rest[t - 1]
            force = [rule(f, theta - before, one[0], one[1], one[2]) for f, one in zip(force, now, strict=True)]
        rest[t], friction[t] = theta, force
    return rest, friction


def _dahl_balance(
    k: float, q: float, need: float, before: float, force: float, sigma: float, plus: float, minus: float
) -> tuple[float, float]:
    """Return the angle at which a linear spring and a Dahl element give what is needed, and the element's force.

    What is left falls and is convex over the way, so Newton's steps from its start never pass the balance.
    """
    left = k * (q - before) + force - need
    sign, level = (1.0, plus) if left > 0 else (-1.0, minus)
    if level == 0.0:
        return q - need / k, 0.0
    own, above, way = sign * force, sign * (k * (q - before) - need), 0.0  # mirrored, so that the way goes towards +
    own = max(own, -level)
    held_now = own
    for _ in range(NEWTON):
        left = above - k * way + held_now
        if left < TORQUE_TOLERANCE:
            break
        way += left / (k + sigma * (held_now + level) / level)
        held_now = -level + (own + level) * exp(-min(sigma * way / level, 700.0))
    return before + sign * way, sign * held_now


def _balance(
    spring: Spring,
    q: float,
    need: float,
    before: float,
    force: list[float],
    now: list[tuple[float, ...]],
    rule: Next,
) -> tuple[float, float]:
    """Return the angle at which spring and friction give what is needed, and what is left there [Nm]."""

    def left(theta: float) -> float:
        friction = sum(rule(f, theta - before, one[0], one[1], one[2]) for f, one in zip(force, now, strict=True))
        return spring.torque(q - theta) + friction - need

    most = sum(max(one[1], one[2]) for one in now)
    low, high = q - spring.torsion(need + most) - SMALLEST, q - spring.torsion(need - most) + SMALLEST
    low, high = min(low, before), max(high, before)
    at_low, at_high = left(low), left(high)
    theta, rest, side = before, left(before), 0
    for i in range(ROUNDS):
        if abs(rest) < TORQUE_TOLERANCE or high - low < SMALLEST:
            break
        if rest > 0:
            low, at_low, at_high, side = theta, rest, at_high / 2 if side > 0 else at_high, 1
        else:
            high, at_high, at_low, side = theta, rest, at_low / 2 if side < 0 else at_low, -1
        secant = low + (high - low) * at_low / (at_low - at_high) if at_low > at_high else low
        theta = secant if i % 4 < 3 and low < secant < high else (low + high) / 2
        rest = left(theta)
    return theta, rest


def motor_path(
    command: Array,
    needed: Array,
    element: Element,
    kp: float,
    fading: Array,
    begins: NDArray[np.bool_],
    law: Law,
) -> tuple[Array, Array]:
    """Return where a motor stands, shape (T,) [rad], and the friction on it, shape (T,) [Nm].

    The servo falls short by e, which grows by (change of torque) / kp and of which integral action leaves a share.

    Args:
        command: Shape (T,) [rad].
        needed: Shape (T,) [Nm], torque of the motor without friction.
        element: Its friction.
        kp: Of the servo [Nm/rad].
        fading: Shape (T,), share of e that is left of that at the instant before.
        begins: Shape (T,), instants at which nothing is remembered.
        law: Of friction.
    """
    rule = LAWS[law]
    drawn = np.where(np.isnan(element.drawn), 2.0, element.drawn).tolist()
    rows = zip(
        command.tolist(),
        needed.tolist(),
        element.stiffness.tolist(),
        element.plus.tolist(),
        element.minus.tolist(),
        drawn,
        fading.tolist(),
        begins.tolist(),
        strict=True,
    )
    q, friction = np.empty(len(command)), np.empty(len(command))
    force = short = torque = x = 0.0
    for t, (wanted, need, sigma, plus, minus, share, left, starts) in enumerate(rows):
        if starts:
            force, short, x = 0.0, 0.0, wanted
        elif abs(share) <= 1:
            force = -share * (plus if share > 0 else minus)
            jump = (need - force - torque) / kp if left == 1.0 else 0.0  # integral action has taken it back since
            short = left * (short + jump)
            x = wanted - short
        else:
            stuck = left * (short + (need - force - torque) / kp)
            step = (wanted - stuck - x) / (1 + left * sigma / kp)  # exact where friction holds; else it slips anyway
            force = rule(force, step, sigma, plus, minus)
            short = left * (short + (need - force - torque) / kp)
            x = wanted - short
        torque = need - force
        q[t], friction[t] = x, force
    return q, friction
