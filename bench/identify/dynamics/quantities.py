"""What the first pass tells, as named quantities with intervals."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.leaning import AXES, axes_across
from bench.identify.dynamics.presliding import level_of
from bench.identify.dynamics.regressor import NAMES
from bench.identify.dynamics.widths import SELDOM
from bench.identify.told import is_told
from bench.record.campaign import Array

Kind = Literal["payload", "gas", "level", "friction", "inertia", "drive"]
DRIVE = {  # column -> name, its unit for a hinge and for a slide
    "coulomb": ("Coulomb friction", "Nm", "N"),
    "viscous": ("viscous friction", "Nm s/rad", "N s/m"),
    "viscous_difference": ("viscous friction, half the difference of directions", "Nm s/rad", "N s/m"),
    "rolling": ("rolling friction, at 1 rad/s or 1 m/s", "Nm", "N"),
    "load": ("friction by the torque passed on", "Nm/Nm", "N/N"),
    "spring": ("stiffness of a dress pack", "Nm/rad", "N/m"),
    "balancer_sin": ("spring balancer, times sin q", "Nm", "N"),
    "balancer_cos": ("spring balancer, times cos q", "Nm", "N"),
    "balancer_sin_2": ("spring balancer, times sin 2q", "Nm", "N"),
    "balancer_cos_2": ("spring balancer, times cos 2q", "Nm", "N"),
    "balancer_sin_3": ("spring balancer, times sin 3q", "Nm", "N"),
    "balancer_cos_3": ("spring balancer, times cos 3q", "Nm", "N"),
    "warming": ("friction that falls, share of it in an hour", "1/h", "1/h"),
    "presliding": ("presliding travel", "rad", "m"),
    "offset": ("torque offset", "Nm", "N"),
}
NAMED = {name: name_and_units[0] for name, name_and_units in DRIVE.items()} | {"balancer": "spring balancer"}
RELATIVE = "relative"  # unit of a quantity that is a share


@dataclass(frozen=True)
class Quantity:
    """One number.

    Attributes:
        kind: Group that it belongs to.
        name: For people: "Coulomb friction (joint2)".
        unit: Of all values.
        nominal: As stated.
        value: As found.
        sigma: Standard error.
        prior_sigma: How well it was known beforehand, with the widths that the evidence chose, and any width of offsets
            and optional friction.
        combine: Shape (p,), its factors of the parameters; of a presliding travel, which is not linear in them, its
            gradient.
        meaning: What is lumped in it, term by term, the most uncertain first; empty: nothing else.
        is_square: Whether it is the square of what data tell, as a presliding travel is.
    """

    kind: Kind
    name: str
    unit: str
    nominal: float
    value: float
    sigma: float
    prior_sigma: float
    combine: Array
    meaning: tuple[str, ...] = ()
    is_square: bool = False

    @property
    def told(self) -> bool:
        """Whether the data say more of it than was known beforehand."""
        return is_told(self.sigma**2, self.prior_sigma**2)

    def interval(self, quantile: float) -> tuple[float, float]:
        """Return the lower and upper end, `quantile` standard errors away; of a square those of its root, squared."""
        if self.is_square and self.value > 0:
            root = np.sqrt(self.value)
            half = quantile * self.sigma / (2 * root)
            return float(max(root - half, 0.0) ** 2), float((root + half) ** 2)
        return self.value - quantile * self.sigma, self.value + quantile * self.sigma


def quantities(found: FirstPass) -> tuple[Quantity, ...]:
    """Return all quantities of a first pass: payload, gas, lean, friction, base inertial parameters, torque scales."""
    layout, every = found.layout, np.eye(found.layout.size)
    result: list[Quantity] = []
    beforehand = found.prior.covariance(found.solution.widths)

    def add(kind: Kind, name: str, unit: str, combine: Array, meaning: tuple[str, ...] = ()) -> None:
        nominal, value = float(combine @ found.prior.mean), float(combine @ found.parameters)
        sigma, prior_sigma = _sigma(combine, found.solution.covariance), _sigma(combine, beforehand)
        result.append(Quantity(kind, name, unit, nominal, value, sigma, prior_sigma, combine, meaning))

    for where, recording in zip(layout.payloads, layout.carried or ("",), strict=False):
        name = f"unstated payload ({recording})" if recording else "unstated payload"
        add("payload", name, "kg", every[where.start])
    if layout.has_gas:
        add("gas", "gas of the counterbalance", "of full", every[layout.gas.start])
    if found.leans:  # named as in the catalogue of effects
        for axis, row in zip(axes_across(found.arm.bodies), every[layout.lean], strict=True):
            add("level", f"floor out of level, lean towards {AXES[axis]}", "rad", row)
    for column in (name for name in DRIVE if name != "presliding"):
        name, *units = DRIVE[column]
        for joint, row in enumerate(every[layout.of_drives(column)]):
            if column.split("_")[0] in SELDOM and row @ beforehand @ row == 0:
                continue  # there is none
            add("friction", f"{name} ({found.joints[joint]})", units[_slides(found, joint)], row)
    result += (_travel(found, joint, beforehand) for joint in found.has["presliding"])
    base = found.base
    for k, name in enumerate(base.names):
        unit = base.units[k]
        if unit == "kg m^2" and name.startswith("rotor") and _slides(found, int(base.joint[k])):
            unit = "kg"
        add("inertia", f"{name} ({found.joints[base.joint[k]]})", unit, base.combine[k], _meaning(found, k))
    for joint, row in enumerate(every[layout.gain]):
        add("drive", f"torque scale ({found.joints[joint]})", RELATIVE, row)
    return tuple(result)


def _travel(found: FirstPass, joint: int, beforehand: Array) -> Quantity:
    """Return the presliding travel of a drive: of its column, with which its torque is likeliest.

    Pulses after turns go with the level of friction times the root of its travel (`presliding.py`). So the column's
    factor errs by as much as that root does, each as a share of itself.

    Args:
        found: A first pass.
        joint: Its index.
        beforehand: Shape (p, p), covariance of the parameters before the data.
    """
    late = np.eye(found.layout.size)[found.layout.of_drives("presliding")][joint]
    friction = float(level_of(found.solution.drives[joint].rows, found.layout) @ found.parameters)
    travel = float(found.travel[joint])
    gradient = 2 * travel / max(friction, np.finfo(float).tiny) * late
    name, *units = DRIVE["presliding"]
    return Quantity(
        kind="friction",
        name=f"{name} ({found.joints[joint]})",
        unit=units[_slides(found, joint)],
        nominal=0.0,
        value=travel,
        sigma=_sigma(gradient, found.solution.covariance),
        prior_sigma=_sigma(gradient, beforehand),
        combine=gradient,
        is_square=True,
    )


def _sigma(combine: Array, covariance: Array) -> float:
    return float(np.sqrt(max(float(combine @ covariance @ combine), 0.0)))


def _slides(found: FirstPass, joint: int) -> bool:
    return not bool(found.nominal.bodies.is_hinge[joint])


def _meaning(found: FirstPass, k: int) -> tuple[str, ...]:
    """Return what else a base parameter is made of, the most uncertain terms first."""
    base, layout = found.base, found.layout
    names = [f"{name} {link + 1}" for link in range(layout.n) for name in NAMES]
    names += [f"payload {name}" for name in NAMES] * len(layout.payloads)
    combine = base.combine[k].copy()
    rotors = np.arange(layout.size)[layout.of_drives("rotor")]
    sigma = np.sqrt(np.sum(found.prior.factor(found.solution.widths) ** 2, axis=1))
    lead = int(base.lead[k])
    words = []
    for i in np.argsort(-np.abs(combine) * sigma):
        if combine[i] != 0 and i != lead:
            name = f"rotor {int(np.flatnonzero(rotors == i)[0]) + 1}" if i in rotors else names[i]
            factor = "" if abs(abs(combine[i]) - 1) < 1e-6 else f"{abs(combine[i]):.3g} "
            words.append(f"{'-' if combine[i] < 0 else '+'} {factor}{name}")
    return tuple(words)
