"""What the figures say of the unknowns before the data are looked at."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from bench.actuators.laws import ROLLING_POWER
from bench.identify.arm import Arm
from bench.identify.dynamics.balancer import balancer_sizes
from bench.identify.dynamics.equations import BALANCER, GAS_SHAPE, OPTIONAL
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import N_INERTIAL, standard_parameters
from bench.identify.dynamics.widths import AS_STATED, NONE, WIDER, Widths
from bench.record.campaign import Array, Campaign
from bench.record.known import PAYLOAD
from bench.robot.nominal_dynamics import NominalDynamics

UPPER = ((0, 0, 1, 0, 1, 2), (0, 1, 1, 2, 2, 2))  # exact: Pinocchio's order of the six entries of an inertia

# assumed: [rad], as the catalogue has it of a floor: bases commonly are level to 0.1 to 0.5 deg, ISO 9283 as makers say
LEVEL = 1e-2

FASTEST = 1.0  # assumed: [1/h], share of its friction that a drive loses in an hour, as the catalogue has it


@dataclass(frozen=True, eq=False)
class Prior:
    """Normal: parameters = mean + L z with z standard normal, and L the sum of its parts by their widths.

    Attributes:
        mean: Shape (p,), nominal figures.
        figures: Shape (p, p), of link and rotor inertia.
        friction: Shape (p, p), of friction that is stated.
        scale: Shape (p, p), of the scales of torques.
        stated_offset: Shape (p, p), of offsets as far as they are stated.
        offset: Shape (n, p, p), of each drive's offset beyond that.
        optional: Shape (7 n, p, p), of each of `OPTIONAL`, drive after drive.
        free: Shape (p, p), of all others.
    """

    mean: Array
    figures: Array
    friction: Array
    scale: Array
    stated_offset: Array
    offset: Array
    optional: Array
    free: Array

    def usual(self) -> Widths:
        """Return the widths to begin with: as stated, other offsets as free as friction, nothing optional."""
        stated = frozenset(i for i, own in enumerate(self.offset) if np.any(self.stated_offset[np.diag(own) > 0]))
        offset = tuple(NONE if i in stated else 0 for i in range(len(self.offset)))
        return Widths(0, 0, offset, (NONE,) * len(self.optional), stated=stated)

    def without(self, name: str, drives: Collection[int]) -> "Prior":
        """Return the same with none of something of `OPTIONAL` at some drives."""
        first = OPTIONAL.index(name) * (len(self.optional) // len(OPTIONAL))
        barred = np.isin(np.arange(len(self.optional)), [first + j for j in drives])
        return replace(self, optional=np.where(barred[:, None, None], 0.0, self.optional))

    def factor(self, widths: Widths) -> Array:
        """Return L, shape (p, p)."""
        stated = WIDER**widths.figures * self.figures + WIDER**widths.friction * self.friction
        found = stated + WIDER**widths.stated_offset * self.stated_offset + WIDER ** float(widths.scale) * self.scale
        found += self.free
        for each, parts in ((widths.offset, self.offset), (widths.optional, self.optional)):
            for width, part in zip(each, parts, strict=True):
                if width != NONE:  # most of what is optional is not there
                    found += WIDER ** float(width) * part
        return np.asarray(found)

    def covariance(self, widths: Widths) -> Array:
        """Return the covariance before the data, shape (p, p), with any width of offsets and of what is optional.

        Scales of torques are as uncertain as stated.
        """
        widths = replace(widths, scale=AS_STATED)
        chosen = self.factor(widths) @ self.factor(widths).T
        total = chosen.copy()
        for line in widths.by_drive():
            factors = [self.factor(other) for other in line]
            total += sum(factor @ factor.T for factor in factors) / len(factors) - chosen
        return total


def weighed(nominal: NominalDynamics, campaign: Campaign) -> NominalDynamics:
    """Return the robot with a payload that is as well known as the lab weighed it, where that is known of all runs."""
    sigma: dict[str, float] = {}
    for one in campaign.known:
        if one.quantity == PAYLOAD:
            sigma[one.recording] = min(one.sigma, sigma.get(one.recording, one.sigma))
    if not sigma or not ("" in sigma or sigma.keys() >= set(campaign.recordings)):
        return nominal
    heaviest = max(one.value for one in campaign.known if one.quantity == PAYLOAD)
    error = max(sigma.values())
    return replace(nominal, payload=heaviest + error, payload_sigma=error)


def prior_of(layout: Layout, nominal: NominalDynamics, arm: Arm, torque_rms: Array, speed_rms: Array) -> Prior:
    """Return the prior of a robot.

    Masses, centres, rotors, friction, gas and stiffness are known as `uncertainty` of the figures says, and a base is
    as level as is common; friction that is not stated is free up to what the whole torque of a joint could be, and so
    is an offset that is not.

    Args:
        layout: Of the parameters.
        nominal: The robot.
        arm: Its links.
        torque_rms: Shape (n,) [Nm], of each joint in the campaign.
        speed_rms: Shape (n,) [rad/s], likewise.
    """
    u, drives, n = nominal.uncertainty, nominal.drive_uncertainty, layout.n
    mean = np.zeros(layout.size)
    figures, friction, scale, stated_offset, free = (np.zeros((layout.size, layout.size)) for _ in range(5))
    mean[layout.links] = standard_parameters(arm.bodies)
    for i in range(n):
        own = slice(N_INERTIAL * i, N_INERTIAL * (i + 1))
        figures[own, own] = link_root(arm, i, u.links * u.mass, u.links * u.centre_of_mass_m)

    def put(where: slice | int, at: Array | float, sigma: Array | float, into: Array) -> None:
        index = np.arange(layout.size)[where]
        mean[index] = at
        into[index, index] = sigma

    own_inertia = np.diag(arm.mass_matrix(np.zeros(n)))
    rotor = np.where(nominal.rotor_inertia > 0, drives.rotor_inertia * nominal.rotor_inertia, own_inertia)
    put(layout.of_drives("rotor"), nominal.rotor_inertia, rotor, figures)
    drag = torque_rms / np.where(speed_rms > 0, speed_rms, 1.0)
    for name, stated, most in (("coulomb", nominal.coulomb, torque_rms), ("viscous", nominal.viscous, drag)):
        put(layout.of_drives(name), stated, drives.friction * stated, friction)
        put(layout.of_drives(name), stated, np.where(stated > 0, 0.0, most), free)
    put(layout.of_drives("offset"), 0.0, nominal.torque_offset_sigma, stated_offset)
    put(layout.gain, 0.0, nominal.torque_gain_sigma, scale)
    if layout.has_payload:
        side = nominal.payload_side
        moments = nominal.payload * np.array([*(side,) * 3, *(side**2,) * 6])  # its centre may be anywhere near
        for one in layout.payloads:
            put(one, 0.0, np.array([nominal.payload_sigma, *moments]), free)
    if layout.has_gas:
        amount = u.gas_constant * nominal.gas_amount if nominal.gas_amount > 0 else 1.0
        full = nominal.counterbalance
        turn = u.geometry_m / min(full.rho, full.b) if full else 0.0  # an anchor that is off by so much
        shape = {"critical_length": u.critical_length_m, "dead_centre": turn, "rho": u.geometry_m, "b": u.geometry_m}
        put(
            layout.gas,
            np.array([nominal.gas_amount, *(0.0,) * 4]),
            np.array([amount, *(shape[k] for k in GAS_SHAPE)]),
            free,
        )
    put(layout.softness, 1.0, drives.stiffness, free)
    put(layout.lean, 0.0, LEVEL, free)
    rolls = torque_rms / np.where(speed_rms > 0, speed_rms, 1.0) ** ROLLING_POWER
    low, high = arm.bodies.limits.T
    springs = torque_rms / np.where(high > low, (high - low) / 2, 1.0)  # the whole torque at either end of the range
    terms = {  # what there is of it at most, by column
        "offset": {"offset": torque_rms},
        "viscous_difference": {"viscous_difference": drag},
        "rolling": {"rolling": rolls},
        "load": {"load": np.ones(n)},  # of what a gear passes on, friction cannot take more
        "spring": {"spring": springs, "offset": torque_rms},  # a dress pack rests anywhere in the range
        "balancer": dict(zip(BALANCER, balancer_sizes(arm).T, strict=True)),
        "warming": {"warming": np.full(n, FASTEST)},
        "presliding": {"presliding": torque_rms},
    }
    offset, *optional = (np.zeros((n, layout.size, layout.size)) for _ in range(1 + len(OPTIONAL)))
    for into, name in zip((offset, *optional), ("offset", *OPTIONAL), strict=True):
        for column, most in terms[name].items():
            where = np.arange(layout.size)[layout.of_drives(column)]
            into[np.arange(n), where, where] = most
    return Prior(mean, figures, friction, scale, stated_offset, offset, np.concatenate(optional), free)


def link_root(arm: Arm, link: int, mass_sigma: float, centre_sigma: float) -> Array:
    """Return L of a link's inertial parameters, shape (10, 10): nominal ones + L z with z standard normal.

    A relative error of the mass scales all of them; an error of the centre moves them; and who knows a centre to s
    knows lengths to s, so an inertia m r^2 to 2 m r s.
    """
    mass, centre = float(arm.bodies.mass[link]), arm.bodies.com[link]
    inertia = arm.bodies.inertia[link]
    gyration = np.sqrt(max(float(np.trace(inertia)), 0.0) / (2 * mass)) if mass > 0 else 0.0
    about = inertia + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    root = np.zeros((N_INERTIAL, 1 + 3 + 6))
    root[:, 0] = mass_sigma * np.array([mass, *(mass * centre), *about[UPPER]])
    for axis in range(3):
        step = np.eye(3)[axis]
        moved = mass * (2 * centre[axis] * np.eye(3) - np.outer(step, centre) - np.outer(centre, step))
        root[:, 1 + axis] = centre_sigma * np.array([0.0, *(mass * step), *moved[UPPER]])
    root[4:, 4:] = 2 * mass * gyration * centre_sigma * np.eye(6)
    return _root(root @ root.T)


def _root(covariance: Array) -> Array:
    """Return a symmetric square root of a positive semidefinite matrix."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)) @ vectors.T)
