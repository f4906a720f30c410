"""Which motion to add, for parameters that these data do not tell."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.identify.dynamics.equations import drive_columns
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.presliding import turned
from bench.identify.dynamics.quantities import Quantity
from bench.identify.dynamics.regressor import N_INERTIAL, link_regressor, payload_columns
from bench.record.campaign import Array

SECONDS = 20.0  # declared: of a motion that is proposed
RATE = 20.0  # effort: [Hz], at which its information is counted; it sways far more slowly
REACH = 0.4  # declared: of a joint's range, either way from its middle
SPEED = 0.6  # declared: of a joint's speed limit: what a careful operator runs
POSTURES = 8  # effort: of the joints that stand still meanwhile
MOST = 3  # declared: motions that are proposed


@dataclass(frozen=True)
class Motion:
    """A motion that would tell more.

    Attributes:
        joints: Indices of the joints that swing.
        posture: Shape (n,) [rad], about which they do, and where the others stand.
        amplitude: Shape (n,) [rad], either way; 0 for joints that stand.
        speed: Shape (n,) [rad/s], top speeds.
        tells: Names of quantities whose variance it would at least halve.
    """

    joints: tuple[int, ...]
    posture: Array
    amplitude: Array
    speed: Array
    tells: tuple[str, ...]


def advise(found: FirstPass, quantities: Sequence[Quantity]) -> tuple[Motion, ...]:
    """Return up to three motions, each the one that tells most of what is not told yet; none where all is told.

    Each joint alone, and all together, swing at unlike frequencies about some postures within the limits. What a motion
    would add is its information at the noise that the drives showed. The same data give the same advice.

    Args:
        found: The first pass.
        quantities: All that were looked for; scales of torques are left out, for only a known payload tells them.
    """
    open_ones = [one for one in quantities if not one.told and one.kind != "drive"]
    motions = list(_candidates(found))
    information = [_information(found, motion) for motion in motions]
    widths = found.solution.widths  # a motion has to tell offsets and optional friction however large they are
    factor = found.prior.factor(widths.all_free())
    inner = np.eye(len(factor)) + factor.T @ found.solution.normal.gram @ factor
    chosen: list[Motion] = []
    while open_ones and len(chosen) < MOST:
        combine = np.stack([one.combine for one in open_ones]) @ factor
        now, *after = (
            np.diag(combine @ np.linalg.solve(inner + factor.T @ added @ factor, combine.T))
            for added in (np.zeros_like(information[0]), *information)
        )
        gains = [variance < now / 2 for variance in after]
        best = int(np.argmax([gain.sum() for gain in gains]))
        if not gains[best].any():
            break
        told = tuple(one.name for one, now in zip(open_ones, gains[best], strict=True) if now)
        chosen.append(Motion(**{**vars(motions[best]), "tells": told}))
        open_ones = [one for one, now in zip(open_ones, gains[best], strict=True) if not now]
        inner = inner + factor.T @ information[best] @ factor
    return tuple(chosen)


def sentence(motion: Motion, found: FirstPass) -> str:
    """Return the advice in words."""
    hinge = found.nominal.bodies.is_hinge
    unit = np.where(hinge, 180 / np.pi, 1e3)
    swings = ", ".join(
        f"{found.joints[j]} by +-{motion.amplitude[j] * unit[j]:.0f} {'deg' if hinge[j] else 'mm'} "
        f"at up to {motion.speed[j] * unit[j]:.0f} {'deg/s' if hinge[j] else 'mm/s'}"
        for j in motion.joints
    )
    own = ["" if np.all(hinge) else " deg" if one else " mm" for one in hinge]
    values = ", ".join(f"{value:.0f}{name}" for value, name in zip(motion.posture * unit, own, strict=True))
    place = f"({values}) deg" if np.all(hinge) else f"({values})"
    return f"To tell {', '.join(motion.tells)}: add {SECONDS:.0f} s in which these swing about {place}: {swings}."


def _candidates(found: FirstPass) -> Sequence[Motion]:
    n, bodies = found.layout.n, found.nominal.bodies
    limits = np.where(np.isfinite(bodies.limits), bodies.limits, np.array([-np.pi, np.pi]))
    middle, half = limits.mean(axis=1), np.ptp(limits, axis=1) / 2
    rng = np.random.default_rng(0)  # part of the rule: the same data give the same advice
    every = [(j,) for j in range(n)] + ([tuple(range(n))] if n > 1 else [])
    motions = []
    for joints in every:
        for posture in range(POSTURES if len(joints) < n else 1):
            place = middle + (rng.uniform(-REACH, REACH, n) * half if posture else 0.0)
            swings = np.isin(np.arange(n), joints)
            place = np.where(swings, middle, place)
            motions.append(
                Motion(
                    joints, place, np.where(swings, REACH * half, 0.0), SPEED * found.nominal.speed_limit * swings, ()
                )
            )
    return motions


def _information(found: FirstPass, motion: Motion) -> Array:
    """Return what a motion would add to the normal equations, shape (p, p)."""
    layout, arm = found.layout, found.arm
    time = np.arange(0, SECONDS, 1 / RATE)[:, None]
    rate = np.divide(motion.speed, motion.amplitude, out=np.zeros(layout.n), where=motion.amplitude > 0)
    rate = rate * 0.9 ** np.arange(layout.n)  # unlike frequencies, else joints that move alike cannot be told apart
    phase = rate * time + np.arange(layout.n)
    position = motion.posture + motion.amplitude * np.sin(phase)
    velocity, acceleration = motion.amplitude * rate * np.cos(phase), -motion.amplitude * rate**2 * np.sin(phase)
    links = link_regressor(arm, position, velocity, acceleration)
    body, payload = payload_columns(arm, found.nominal.load_point)
    carried = links[:, :, N_INERTIAL * body : N_INERTIAL * (body + 1)] @ payload
    total = np.zeros((layout.size, layout.size))
    spread = np.array([np.nan if one is None else one.variance * one.memory for one in found.solution.noise])
    if not np.isfinite(spread).any():
        return total
    spread = np.where(np.isfinite(spread), spread, np.nanmax(spread))
    every = np.arange(layout.size)
    passed = found.rubbing.torque(found.rubbing.arm, position, velocity, acceleration)
    turning = turned(position, found.travel[None])[:, 0]
    own = drive_columns(position, velocity, acceleration, passed, turning, arm.bodies.is_hinge)
    for j in motion.joints:
        factors = np.zeros((len(time), layout.size))
        factors[:, layout.links] = links[:, j]
        if layout.has_payload:
            factors[:, layout.payload] = carried[:, j]
        factors[:, every[layout.drives].reshape(layout.n, -1)[j]] = own[:, j]
        if layout.has_gas and found.nominal.counterbalance is not None and found.nominal.counterbalance.joint == j:
            factors[:, layout.gas.start] = found.nominal.counterbalance.torque(position[:, j])
        total += factors.T @ factors / spread[j]
    return total
