"""The second plant's arm as plain numbers, and the list of what its friction, springs and gas can do."""

from dataclasses import dataclass, field, replace
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

from bench.second.readout import Readout

Array = NDArray[np.float64]
Law = Literal["elasto-plastic", "dahl"]

ROOM_K = 293.15  # at which figures are as stated


@dataclass(frozen=True, eq=False)
class Lump:
    """A rigid mass that moves with a joint.

    Attributes:
        name: Of the body, as the robot's files name it.
        joint: Index of the joint.
        mass: [kg].
        com: Shape (3,) [m], in the joint's frame.
        inertia: Shape (3, 3) [kg m^2], about the centre of mass, in the axes of the joint's frame.
        axes: Shape (3, 3), of the body in the joint's frame.
    """

    name: str
    joint: int
    mass: float
    com: Array
    inertia: Array
    axes: Array


@dataclass(frozen=True, eq=False)
class Spot:
    """A point that moves with a joint: position, shape (3,) [m], and axes, shape (3, 3), in the joint's frame."""

    joint: int
    position: Array
    axes: Array


@dataclass(frozen=True, eq=False)
class Friction:
    """Friction of n drives on one side of their springs; every attribute has shape (n,).

    Attributes:
        level: Sliding friction [Nm].
        stiffness: While it holds [Nm/rad]; level over stiffness is the presliding travel.
        rise, speed: Stribeck's rise at standstill, relative, and the speed at which it has fallen to 1/e [rad/s].
        asymmetry: Relative surplus towards +, deficit towards -.
        sin, cos, period: Ripple over the angle, relative; its period [rad].
        by_load: Level per transmitted torque.
        mixed: Level per transmitted torque that waves over the angle, by_load (1 + sin(2 pi x / period)).
    """

    level: Array
    stiffness: Array
    rise: Array
    speed: Array
    asymmetry: Array
    sin: Array
    cos: Array
    period: Array
    by_load: Array
    mixed: Array

    @classmethod
    def plain(cls, level: Array, stiffness: Array) -> Self:
        """Return friction of constant level."""
        none, one = np.zeros_like(level), np.ones_like(level)
        return cls(level, stiffness, none, one, none, none, none, one, none, none)

    def levels(self, x: Array, velocity: Array, load: Array) -> tuple[Array, Array]:
        """Return the levels against motion towards + and towards -, shape (T, n) each [Nm].

        Args:
            x: Shape (T, n) [rad].
            velocity: Shape (T, n) [rad/s].
            load: Shape (T, n) [Nm], transmitted torque.
        """
        phase = 2 * np.pi * x / self.period
        with np.errstate(under="ignore"):
            base = self.level * (1 + self.rise * np.exp(-((velocity / self.speed) ** 2)))
        base = base * np.maximum(1 + self.sin * np.sin(phase) + self.cos * np.cos(phase), 0)
        pressed = np.abs(load) * (self.by_load + self.mixed * (1 + np.sin(phase)))
        return base * (1 + self.asymmetry) + pressed, base * (1 - self.asymmetry) + pressed


@dataclass(frozen=True, eq=False)
class Springs:
    """The elastic elements of n drives; every attribute has shape (n,).

    With the torsion x beyond the play, tau = k (x - s x_k tanh(x / x_k)), x_k = knee / k.

    Attributes:
        stiffness: k [Nm/rad].
        softness: s; below zero the element hardens towards the middle.
        knee: Torque at the knee [Nm].
        gap: Play [rad].
    """

    stiffness: Array
    softness: Array
    knee: Array
    gap: Array


@dataclass(frozen=True, eq=False)
class Gas:
    """A gas-loaded cylinder between two links that pulls with F = C/(l_c - l), Eq. (8) of the paper.

    Attributes:
        joint: Index of the hinge.
        rho, b: Distances of the fixed and the moving anchor from the hinge [m].
        dead_centre: Angle at which the cylinder is shortest [rad].
        constant: C [Nm].
        critical_length: l_c [m].
        area: Of the piston, by which the gauge's reading is the gas force [m^2]; nan without a gauge.
        exponent: Polytropic exponent n, (l_c - l)^n in place of l_c - l, with the same pull at angle zero.
        amount: Gas that is left at the start of the campaign, relative.
        leak: Share that leaves in an hour, at a constant rate.
        seal: Friction of the seals as a part of the gas force.
        seal_travel: In which it builds up [m].
    """

    joint: int
    rho: float
    b: float
    dead_centre: float
    constant: float
    critical_length: float
    area: float
    exponent: float = 1.0
    amount: float = 1.0
    leak: float = 0.0
    seal: float = 0.0
    seal_travel: float = 1e-4

    def length(self, theta: Array) -> Array:
        """Return the distance of the anchors [m] over the joint angle [rad]."""
        return np.sqrt(self.rho**2 + self.b**2 - 2 * self.rho * self.b * np.cos(theta - self.dead_centre))

    def lever(self, theta: Array) -> Array:
        """Return dl/dtheta [m/rad]."""
        return self.rho * self.b * np.sin(theta - self.dead_centre) / self.length(theta)

    def pull(self, theta: Array, hours: Array) -> Array:
        """Return the force of the gas on the rod [N], without the seals' friction.

        Args:
            theta: Shape (T,) [rad].
            hours: Shape (T,), since the start of the campaign.
        """
        at_zero = self.critical_length - float(self.length(np.zeros(1))[0])
        gap = self.critical_length - self.length(theta)
        left = self.amount * np.maximum(1 - self.leak * hours, 0)
        force: Array = left * self.constant / gap * (at_zero / gap) ** (self.exponent - 1)
        return force


@dataclass(frozen=True, eq=False)
class Servo:
    """How the servos give, shape (n,) each: q falls short by what is left of torque / kp.

    Attributes:
        kp: [Nm/rad].
        decay: Rate at which integral action takes that back [1/s]; 0: it never does.
    """

    kp: Array
    decay: Array


@dataclass(frozen=True, eq=False)
class Figures:
    """The arm of the second plant; n drives.

    Attributes:
        parent: Shape (n,), joint that carries a joint, -1 for the base.
        position, rotation: Shape (n, 3) [m] and (n, 3, 3), of joint frames in their parents' at zero.
        axis: Shape (n, 3), of each hinge in its own frame.
        lumps: Masses.
        load: Where loads hang and payloads are bolted on.
        reflectors: Where the tracker looks.
        gravity: Shape (3,) [m/s^2].
        springs, motor, link, servo, gas: As above; `motor` and `link` are the two sides' friction.
        law: By which friction builds up.
        rotor_inertia, viscous: Shape (n,) [kg m^2], [Nm s/rad], reflected to the joint.
        torque_limit: Shape (n,) [Nm].
        payload_change: Relative error of what is bolted on.
        hung_change: Relative error of what is hung on.
        payload_com: Shape (3,) [m], its centre of mass beside the load point.
        base_compliance: Of the foundation about both horizontal axes [rad/Nm].
        dents: (joint, torque [Nm], angle [rad], width [rad]): torques over a narrow angle.
        readout: Of the instruments.
    """

    parent: NDArray[np.int64]
    position: Array
    rotation: Array
    axis: Array
    lumps: tuple[Lump, ...]
    load: Spot
    reflectors: tuple[Spot, ...]
    gravity: Array
    springs: Springs
    motor: Friction
    link: Friction
    servo: Servo
    gas: Gas | None
    rotor_inertia: Array
    viscous: Array
    torque_limit: Array
    readout: Readout
    law: Law = "elasto-plastic"
    payload_change: float = 0.0
    hung_change: float = 0.0
    payload_com: Array = field(default_factory=lambda: np.zeros(3))
    base_compliance: float = 0.0
    dents: tuple[tuple[int, float, float, float], ...] = ()

    @property
    def n(self) -> int:
        """Number of drives."""
        return len(self.parent)

    def with_payload(self, mass: float) -> Self:
        """Return the arm with a mass [kg] bolted to the load point, as it truly is."""
        if mass == 0:
            return self
        place = self.load.position + self.load.axes @ self.payload_com
        lump = Lump("payload", self.load.joint, mass * (1 + self.payload_change), place, np.zeros((3, 3)), np.eye(3))
        return replace(self, lumps=(*self.lumps, lump))
