"""Learned torques and gear errors, as torque tables and friction elements of the model."""

import mujoco
import numpy as np

from bench.actuators.laws import TorqueTable
from bench.effects.conditions import Conditions
from bench.effects.effect import Array, Parameter, Place, Values
from bench.effects.friction_elements import DRAG, Side, coulomb, element_name, give_side, set_coulomb
from bench.effects.gear_kinematics import table_range
from bench.effects.learned import Learned
from bench.effects.places import drive_of
from bench.effects.plugin_actuators import add_fixed_tendon, add_torque_table
from bench.robot.compiled import SpecEdit
from bench.robot.figures import Drive
from bench.robot.folder import Robot
from bench.robot.plugins import attributes_of, number_of

LEAST_SPACING = 0.1  # effort: of the largest speed; nodes that lie closer would make a polynomial swing
MOST_COEFFICIENTS = 1 + len(DRAG)  # exact: a friction level, and these
LEAST_COMPLIANCE = 0.1  # rounding: of the stated one: however far a fit tries, a gear that gives stays one
STEEPEST = 2.5  # assumed: times the stiffness of the element; a gear error that stiffens it more is smoothed
KNOTS = 241  # rounding: of a table along an element
ANGLE_KNOTS = 1001  # rounding: of a table over an angle that is even between them: 30 between two of 33 nodes


class _Nodes(Learned):
    """A torque at nodes.

    Args:
        parameters: Its values, k of them.
        nodes: Shape (k,), rising; where.
        side: Of the elastic element.
    """

    def __init__(self, parameters: tuple[Parameter, ...], nodes: Array, side: Side = "link") -> None:
        super().__init__(parameters)
        self.nodes = nodes
        self.side = side

    def tabulated(self, torque: Array) -> tuple[float, float, tuple[float, ...]]:
        """Return first and last angle and torques at equal distances, from torques at the nodes, shape (k,)."""
        first, last = float(self.nodes[0]), float(self.nodes[-1])
        count = round((last - first) / float(np.diff(self.nodes).min())) + 1
        return first, last, tuple(np.interp(np.linspace(first, last, count), self.nodes, torque).tolist())

    def joint_of(self, drive: Drive) -> str:
        """Return the joint on which it acts."""
        return drive.joint if self.side == "link" else drive.rotor


class LearnedTorque(_Nodes):
    """A torque over the angle."""

    name = "learned_torque"
    title = "torque over the angle, as learned"
    physics = "A conservative torque on link or rotor, linear between the angles at which it is given."

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        torque = self.sizes(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            joint = self.joint_of(drive_of(robot, place))
            first, last, table = self.tabulated(torque)
            law = TorqueTable(angle_min=first, angle_max=last, forward=table, backward=table)
            add_torque_table(spec, f"{self.name} {joint}", law, joint=joint)

        return change if np.any(torque) else None


class LearnedFriction(_Nodes):
    """A torque over the angle that turns round with the direction: more or less friction there.

    A table can only add friction. Where friction is to fall, the Coulomb level of the element beside it falls by the
    largest relief that is asked for, over the whole range, and the table puts the rest back elsewhere. What would take
    away more than is there takes away all: friction never drives.
    """

    name = "learned_friction"
    title = "friction over the angle, as learned"
    physics = (
        "The level of friction becomes f_C - T(angle), T the torque in motion towards +, never below 0; linear between "
        "the angles at which T is given. A friction element and a torque table share it."
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        torque = self.sizes(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            nominal = coulomb(spec, drive, self.side)
            relief = float(np.clip(torque.max(), 0.0, nominal))
            level = np.maximum(relief - torque, 0.0)
            set_coulomb(spec, drive, self.side, nominal - relief)
            if not np.any(level):
                return
            # both slip within the travel in which the element alone did
            share = float(level.max()) / (nominal - relief + float(level.max()))
            stiffness = share * number_of(spec, element_name(drive, self.side), "presliding_stiffness")
            first, last, table = self.tabulated(level)
            law = TorqueTable(
                angle_min=first,
                angle_max=last,
                forward=tuple(-x for x in table),
                backward=table,
                presliding_stiffness=stiffness,
            )
            joint = self.joint_of(drive)
            add_torque_table(spec, f"{self.name} {joint}", law, joint=joint)

        return change if np.any(torque) else None


class LearnedDrag(_Nodes):
    """A torque over speed that turns round with the direction.

    A polynomial through the nodes. Beyond the largest speed, where nobody measured, it goes on as steep as it is there,
    and where it falls there, it stays: friction never drives.
    """

    name = "learned_drag"
    title = "friction over speed, as learned"
    physics = (
        "Friction grows by a0 + a1 |v| + a2 v^2 + a3 |v|^3, as many terms as speeds at which it is given; beyond the "
        "largest it goes on as steep as it is there, and falls no further."
    )

    @staticmethod
    def speeds(speeds: Array) -> Array:
        """Return those of some speeds, rising, that a polynomial can go through."""
        kept = [float(speeds[-1])]
        for speed in speeds[-2::-1]:
            if kept[-1] - speed > LEAST_SPACING * kept[0]:
                kept.append(float(speed))
        while len(kept) > MOST_COEFFICIENTS:
            del kept[1]
        return np.array(kept[::-1])

    @staticmethod
    def through(nodes: Array, speeds: Array) -> Array:
        """Return polynomials over speeds, shape (T,), each 1 at one of the nodes and 0 at the others, shape (T, k)."""
        top = nodes[-1]
        powers = np.vander(nodes / top, increasing=True)
        return np.asarray(np.linalg.solve(powers.T, np.vander(speeds / top, len(nodes), increasing=True).T).T)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        torque = self.sizes(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            level, *drag = _polynomial(self.nodes, -torque)
            set_coulomb(spec, drive, self.side, max(coulomb(spec, drive, self.side) + level, 0.0))
            there = attributes_of(spec, element_name(drive, self.side))
            more = {key: float(there.get(key, "0")) + x for key, x in zip(DRAG, drag, strict=False)}
            if any(more.values()):
                top = max(float(self.nodes[-1]), float(there.get("drag_speed", "0")))
                give_side(spec, robot, drive, self.side, **more, drag_speed=top)

        return change if np.any(torque) else None


class LearnedGearError(_Nodes):
    """A gear that turns the link too far or too little, over the angle."""

    name = "learned_gear_error"
    title = "error of the gear over the angle, as learned"
    physics = (
        "The link is e(angle) too far: the elastic element carries k (q + e - theta). Two torque tables, +k e on the "
        "link and -k e on the rotor."
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        error = self.sizes(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            for joint, sign in ((drive.joint, 1.0), (drive.rotor, -1.0)):
                first, last, table = self.tabulated(sign * _stiffness(spec, drive) * error)
                law = TorqueTable(angle_min=first, angle_max=last, forward=table, backward=table)
                add_torque_table(spec, f"{self.name} {joint}", law, joint=joint)

        return change if np.any(error) else None


class LearnedTorsion(_Nodes):
    """A gear that turns the link too far or too little, over the torque that it transmits."""

    name = "learned_torsion"
    title = "torsion of the gear over its load, as learned"
    physics = (
        "Under the torque tau the link is e(tau) too far: the element is twisted by tau/k - e(tau). A torque table "
        "along the elastic element adds -k e there."
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        error = self.sizes(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            stiffness = _stiffness(spec, drive)
            elastic = self.nodes / stiffness
            steps = np.maximum(np.diff(elastic - error), np.diff(elastic) / STEEPEST)
            twist = elastic[0] - error[0] + np.concatenate([np.zeros(1), np.cumsum(steps)])
            law = TorqueTable.of(
                lambda x: np.interp(x, twist, stiffness * (twist - elastic)), float(twist[0]), float(twist[-1]), KNOTS
            )
            add_torque_table(spec, f"{self.name} {drive.element}", law, tendon=drive.element)

        return change if np.any(error) else None


class LearnedCompliance(_Nodes):
    """A gear that gives more or less over the angle."""

    name = "learned_compliance"
    title = "compliance of the gear over the angle, as learned"
    physics = (
        "The element gives by tau (1 + x(angle))/k. With y = x/(1 + x) it has k y u^2/2 less energy at the torsion u, "
        "which is G(theta + u) + G(theta - u) - 2 G(theta) with G'' = k y/2, to third order of u: three torque tables, "
        "of the rotor, of a tendon 2 theta - q and of the link."
    )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = self.sizes(values)

        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            drive = drive_of(robot, place)
            angle = np.linspace(*table_range(spec, drive.joint), ANGLE_KNOTS)
            more = np.interp(angle, self.nodes, np.maximum(change, LEAST_COMPLIANCE - 1))
            slope = _stiffness(spec, drive) * more / (1 + more) / 2
            torque = np.concatenate([np.zeros(1), np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(angle))])
            mirrored = f"{self.name} {drive.element}"
            tendon = add_fixed_tendon(spec, mirrored, {drive.joint: 2.0, drive.rotor: -1.0})
            one, two = (_table(angle, factor * torque) for factor in (1.0, -2.0))
            add_torque_table(spec, f"{self.name} {drive.rotor}", one, joint=drive.rotor)
            add_torque_table(spec, mirrored, one, tendon=tendon)
            add_torque_table(spec, f"{self.name} {drive.joint}", two, joint=drive.joint)

        return edit if np.any(change) else None


def _table(angle: Array, torque: Array) -> TorqueTable:
    """Return a conservative torque, shape (k,), at equally spaced angles, shape (k,)."""
    values = tuple(torque.tolist())
    return TorqueTable(angle_min=float(angle[0]), angle_max=float(angle[-1]), forward=values, backward=values)


def _polynomial(nodes: Array, values: Array) -> list[float]:
    """Return the coefficients of the polynomial through some values, constant first."""
    top = float(nodes[-1])
    scaled = np.linalg.solve(np.vander(nodes / top, increasing=True), values)
    return [float(x) for x in scaled / top ** np.arange(len(nodes))]


def _stiffness(spec: mujoco.MjSpec, drive: Drive) -> float:
    return float(np.asarray(spec.tendon(drive.element).stiffness)[0])
