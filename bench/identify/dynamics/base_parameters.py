"""Which combinations of inertial parameters the torques of an arm depend on at all: its base parameters.

M. Gautier, "Numerical calculation of the base inertial parameters of robots", Journal of Robotic Systems 8(4), 1991:
of the columns of the regressor over random motions, in order, those are kept that do not depend on earlier ones; what
was left out is regrouped with them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import N_INERTIAL, NAMES, UNITS, link_regressor, payload_columns
from bench.record.campaign import Array

# rounding: of a column's length; random motions leave 1e-13 of a dependent one and 1e-3 of an independent one
DEPENDENT = 1e-8
SHOWN = 1e-6  # rounding: coefficients below that are rounding


@dataclass(frozen=True)
class BaseParameters:
    """Base parameters = `combine` times all parameters of the first pass.

    Attributes:
        names: Of the parameters that lead them, length b: "Izz 1", "rotor 3".
        units: Theirs.
        joint: Shape (b,), index of the joint whose link or rotor leads.
        combine: Shape (b, p), zero but for links, payload and rotors.
        lead: Shape (b,), index of the leading parameter.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    joint: NDArray[np.int64]
    combine: Array
    lead: NDArray[np.int64]


def base_parameters(arm: Arm, layout: Layout, load_point: str) -> BaseParameters:
    """Return the base parameters of an arm with a rotor on each joint."""
    n = layout.n
    rng = np.random.default_rng(0)  # any motion serves
    limits = np.where(np.isfinite(arm.bodies.limits), arm.bodies.limits, [-np.pi, np.pi])
    count = 3 * (N_INERTIAL + 1)  # n rows each: three times as many rows as columns
    position = limits[:, 0] + np.ptp(limits, axis=1) * rng.random((count, n))
    velocity, acceleration = rng.standard_normal((2, count, n))
    links = link_regressor(arm, position, velocity, acceleration).reshape(count * n, -1)
    rotors = np.einsum("tj,jk->tjk", acceleration, np.eye(n)).reshape(count * n, n)
    columns = np.hstack([links, rotors])
    kept = _independent(columns)
    regrouped = np.linalg.lstsq(columns[:, kept], columns)[0]
    regrouped[np.abs(regrouped) < SHOWN] = 0.0
    combine = np.zeros((len(kept), layout.size))
    combine[:, layout.links] = regrouped[:, : N_INERTIAL * n]
    combine[:, layout.of_drives("rotor")] = regrouped[:, N_INERTIAL * n :]
    if layout.has_payload:
        body, payload = payload_columns(arm, load_point)
        carried = combine[:, N_INERTIAL * body : N_INERTIAL * (body + 1)] @ payload
        combine[:, layout.payload] = np.where(np.abs(carried) < SHOWN, 0.0, carried)
    is_rotor = kept >= N_INERTIAL * n
    rotor_of = np.arange(layout.size)[layout.of_drives("rotor")]
    return BaseParameters(
        names=tuple(
            f"rotor {k - N_INERTIAL * n + 1}"
            if k >= N_INERTIAL * n
            else f"{NAMES[k % N_INERTIAL]} {k // N_INERTIAL + 1}"
            for k in kept
        ),
        units=tuple("kg m^2" if k >= N_INERTIAL * n else UNITS[k % N_INERTIAL] for k in kept),
        joint=np.where(is_rotor, kept - N_INERTIAL * n, kept // N_INERTIAL),
        combine=combine,
        lead=np.where(is_rotor, rotor_of[np.maximum(kept - N_INERTIAL * n, 0)], kept),
    )


def _independent(columns: Array) -> NDArray[np.int64]:
    """Return the indices of the columns that do not depend on earlier ones."""
    longest = float(np.linalg.norm(columns, axis=0).max())
    kept: list[int] = []
    basis = np.zeros((len(columns), 0))
    for k, column in enumerate(columns.T):
        length = float(np.linalg.norm(column))
        rest = column - basis @ (basis.T @ column)
        rest -= basis @ (basis.T @ rest)  # once more: rounding
        size = float(np.linalg.norm(rest))
        if length > DEPENDENT * longest and size > DEPENDENT * length:
            kept.append(k)
            basis = np.column_stack([basis, rest / size])
    return np.array(kept, dtype=np.int64)
