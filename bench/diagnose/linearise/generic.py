"""What nobody listed: torques, gear and sensor errors, compliance as free functions of angle, direction, speed, load.

Each block is one place and one dependence with a handful of free coefficients. If a block explains what the catalogue
cannot, the cause is unlisted, and the block says where it acts, on what it depends, and how it runs.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bench.diagnose.linearise.linearised_model import WHITENED_TOGETHER, LinearisedModel
from bench.diagnose.replay.instants import at_each_instant
from bench.diagnose.replay.world import NOMINAL
from bench.effects.gear_kinematics import TransmissionError
from bench.effects.learned_readings import force_of, in_room, in_time, of_reading, under_force
from bench.effects.learned_torques import LEAST_SPACING, LearnedDrag
from bench.effects.masses import TorqueOffset
from bench.effects.places import HEAVY_TORQUE
from bench.effects.sensing_bench import TrackerFrame
from bench.effects.sensing_drive import TorqueConstant
from bench.effects.transmission import JointCompliance
from bench.record.campaign import Array
from bench.record.moving import TRAVELS
from bench.record.units import HOUR
from bench.simulate.trace import Trace

ANGLE_NODES = 17  # effort: of a free shape over an angle, in a search; with nine a dent of 4 degrees is not seen
# effort: of a torque over the angle alone, beside that: joints move over 70 to 260 degrees in a day, where 17 nodes are
# 4 to 16 degrees apart; a ripple of 12 degrees was noise. Friction that ripples and gears that err are listed.
FINE_NODES = 33
SPEED_NODES = 4  # effort: of one over speed
LOAD_NODES = 7  # effort: of one over the load
# What is not listed is taken to be as large as what is listed at such a place; other widths are tried, too (`WIDTHS`).

# derived: plausible size of an unlisted torque, of the largest that the motor pays: a listed offset of a torque
TORQUE_SHARE = TorqueOffset.parameters[0].sigma / HEAVY_TORQUE
# derived: plausible size of an unlisted error of a reading, of the largest reading: a listed error of a torque constant
READING_SHARE = TorqueConstant.parameters[0].sigma
# derived: [rad], plausible size of an unlisted error of a gear: a listed transmission error
GEAR_ANGLE = TransmissionError.parameters[0].sigma
# derived: plausible size of an unlisted compliance of a gear, of the stated one: a listed change of it
COMPLIANCE = JointCompliance.parameters[0].sigma
# derived: [m], plausible size of an unlisted error of the tracker over its room, in an hour, under force: a listed
# shift of its frame
TRACKER_ERROR = TrackerFrame.parameters[0].sigma
LEAST_FORCE = 1.0  # rounding: [N]; below, nothing pulls at the load point
LEAST_LOAD = 1.0  # rounding: [Nm] or [N]; a joint whose load changes by less shows no dependence on it


@dataclass(frozen=True, eq=False)
class Block:
    """One place and one dependence.

    Attributes:
        place: "joint 2", "drive 3", "tracker", "reflector 1", "gauge".
        kind: "link torque", "motor torque", "gear angle", "compliance" (of the gear, relative), "reading".
        depends_on: "angle", "angle and direction", "speed", "load", "place", "time", "force".
        drive: Index of the drive, or -1.
        reflector: Index of the reflector, or -1.
        unit: Of the coefficients.
        nodes: Shape (k,), where each coefficient sits, in the unit of what it depends on; empty: polynomial.
        prior: Standard deviation of a coefficient as plausible, in `unit`.
        columns: Shape (m, k), whitened.
        functions: Shape (k,), which of the functions that a polynomial may have each coefficient belongs to.
        origin, size: What it depends on is counted from `origin`, in units of `size`.
        angle_nodes: Number of nodes that shapes over an angle have, those that leave no trace too.
    """

    place: str
    kind: str
    depends_on: str
    drive: int
    unit: str
    nodes: Array
    prior: float
    columns: Array = field(default_factory=lambda: np.empty((0, 0)))
    functions: tuple[int, ...] = ()
    origin: Array = field(default_factory=lambda: np.zeros(1))
    size: float = 1.0
    reflector: int = -1
    angle_nodes: int = ANGLE_NODES

    @property
    def plausible(self) -> Array:
        """Shape (k,), standard deviations of the coefficients."""
        return np.full(self.columns.shape[1], self.prior)

    def __str__(self) -> str:
        return f"{self.kind} at {self.place}, depending on {self.depends_on}"


def blocks_of(linear: LinearisedModel) -> tuple[Block, ...]:
    """Return the blocks that a campaign can say something about; torques over the angle with both numbers of nodes."""
    shapes = _shapes(linear, ANGLE_NODES, FINE_NODES)
    return tuple(block for block in _whitened(linear, shapes) if block is not None)


def anew(linear: LinearisedModel, block: Block, angle_nodes: int | None = None) -> Block:
    """Return a block as another design whitens it, and with another number of nodes if it depends on the angle."""
    count = block.angle_nodes if angle_nodes is None else angle_nodes
    one = next((shape, raw) for shape, raw in _shapes(linear, count) if str(shape) == str(block))
    (found,) = _whitened(linear, [one])
    assert found
    return found


def blocks_at(linear: LinearisedModel, drive: int, angle_nodes: Iterable[int]) -> tuple[Block, ...]:
    """Return the blocks at one drive, or of the tracker (-1), with every number of nodes over the angle.

    They act where the joint stands while others move, too, as listed causes do that have to stand beside them: a torque
    at every angle holds a constant one.

    Args:
        linear: The campaign.
        drive: Index.
        angle_nodes: Numbers of nodes.
    """
    found: dict[tuple[str, int], tuple[Block, Array]] = {}
    for count in angle_nodes:
        for shape, raw in _shapes(linear, count, acts_idle=True):
            if shape.drive == drive:
                found.setdefault((str(shape), raw.shape[2]), (shape, raw))
    return tuple(block for block in _whitened(linear, found.values()) if block is not None)


def _whitened(linear: LinearisedModel, shapes: Iterable[tuple[Block, Array]]) -> Iterator[Block | None]:
    """Yield blocks with their columns from raw ones, shape (T, c, k); None for one that leaves no trace."""
    some: list[tuple[Block, Array]] = []
    for one in shapes:
        some.append(one)
        if sum(raw.shape[2] for _, raw in some) >= WHITENED_TOGETHER:
            yield from _seen(linear, some)
            some = []
    if some:
        yield from _seen(linear, some)


def _seen(linear: LinearisedModel, shapes: Sequence[tuple[Block, Array]]) -> Iterator[Block | None]:
    """Yield blocks without the columns that leave no trace."""
    white = linear.whiten(np.concatenate([raw for _, raw in shapes], axis=2))
    start = 0
    for shape, raw in shapes:
        columns = white[:, start : start + raw.shape[2]]
        start += raw.shape[2]
        size = np.linalg.norm(columns, axis=0)
        seen = size > 1e-9 * max(float(np.max(size)), 1e-300)
        if not np.any(seen):
            yield None
            continue
        nodes = shape.nodes[seen] if len(shape.nodes) else shape.nodes
        own = tuple(np.flatnonzero(seen).tolist())
        count = len(shape.nodes) or ANGLE_NODES
        yield replace(shape, nodes=nodes, columns=columns[:, seen], functions=own, angle_nodes=count)


def hats(values: Array, nodes: Array) -> Array:
    """Return piecewise linear functions of `values`, shape (T,), one for each node, shape (T, k)."""
    return np.stack([np.interp(values, nodes, row) for row in np.eye(len(nodes))], axis=1)


def _shapes(
    linear: LinearisedModel, angle_nodes: int, *finer: int, acts_idle: bool = False
) -> Iterator[tuple[Block, Array]]:
    """Yield blocks without columns, each with its raw ones, shape (T, c, k).

    Args:
        linear: The campaign.
        angle_nodes: Number of nodes over an angle.
        finer: Others, of torques over the angle alone, that are yielded beside these.
        acts_idle: Whether they act on joints that stand while others move, where friction is anywhere.
    """
    segments = linear.segments
    trace = linear.replay.trace(NOMINAL)
    link = np.concatenate([response.link for response in linear.responses])
    motor = np.concatenate([response.motor for response in linear.responses])
    stiffness = linear.replay.compiled.stiffness
    is_static = at_each_instant(segments, [segment.is_static for segment in segments])
    standing = at_each_instant(segments, [segment.standing for segment in segments])
    direction = np.where(standing | is_static[:, None], 0.0, np.sign(trace.q_velocity))
    if not acts_idle:
        idle = standing & ~is_static[:, None]  # whose friction is anywhere: it says nothing of the joint
        link, motor = np.where(idle[:, None], 0.0, link), np.where(idle[:, None], 0.0, motor)
    names = [drive.joint for drive in linear.replay.compiled.robot.figures.drives]
    for j in range(len(names)):
        angle, way, speed = trace.q[:, j], direction[:, j], np.abs(trace.q_velocity[:, j])
        moves = way != 0
        transmitted = stiffness[j] * (trace.q[:, j] - trace.theta[:, j])
        place = f"joint {j + 1}"
        gear = link[:, :, j] * stiffness[j]
        gear[:, [q.is_drive for q in linear.quantities]] = 0.0
        torque = TORQUE_SHARE * float(np.max(np.abs(trace.motor_torque[:, j])))
        # a gear that gives x more under the torque that it transmits turns the link x/k times that less far
        gives = gear * (-transmitted / stiffness[j])[:, None]
        for kind, unit, prior, response in (
            ("link torque", "Nm", torque, link[:, :, j]),
            ("motor torque", "Nm", torque, motor[:, :, j]),
            ("gear angle", "rad", GEAR_ANGLE, gear),
            ("compliance", "", COMPLIANCE, gives),
        ):
            is_torque = unit == "Nm"
            if not np.any(response):
                continue
            if np.ptp(angle) > TRAVELS:
                counts = (angle_nodes, *finer) if is_torque else (angle_nodes,)
                for nodes in (np.linspace(np.min(angle), np.max(angle), count) for count in counts):
                    table = hats(angle, nodes)
                    yield Block(place, kind, "angle", j, unit, nodes, prior), response[:, :, None] * table[:, None, :]
                if is_torque and np.any(way > 0) and np.any(way < 0):
                    nodes = np.linspace(np.min(angle), np.max(angle), angle_nodes)
                    directed = hats(angle, nodes) * way[:, None]
                    yield (
                        Block(place, kind, "angle and direction", j, unit, nodes, prior),
                        response[:, :, None] * directed[:, None, :],
                    )
            if is_torque and np.any(moves):
                fast = speed[moves]
                if np.min(fast) < (1 - LEAST_SPACING) * np.max(fast):
                    nodes = LearnedDrag.speeds(np.quantile(fast, np.linspace(0.02, 1, SPEED_NODES)))
                    directed = LearnedDrag.through(nodes, speed) * way[:, None]
                    yield (
                        Block(place, kind, "speed", j, unit, nodes, prior),
                        response[:, :, None] * directed[:, None, :],
                    )
            spread = np.max(np.abs(transmitted))
            if spread > LEAST_LOAD:
                nodes = np.linspace(np.min(transmitted), np.max(transmitted), LOAD_NODES)
                table = hats(transmitted, nodes)
                if kind == "gear angle":
                    yield Block(place, kind, "load", j, unit, nodes, prior), response[:, :, None] * table[:, None, :]
                elif is_torque and np.any(moves):
                    directed = table * way[:, None]
                    yield Block(place, kind, "load", j, unit, nodes, prior), response[:, :, None] * directed[:, None, :]
    yield from _sensors(linear, trace)
    if linear.replay.compiled.counterbalance:
        j = linear.replay.compiled.counterbalance.joint
        yield from _gauge(linear, trace.q[:, j], direction[:, j], angle_nodes)


def _gauge(linear: LinearisedModel, angle: Array, way: Array, angle_nodes: int) -> Iterator[tuple[Block, Array]]:
    """Yield what a gauge of the counterbalance may read too much on the way out and too little on the way back.

    Without it a gauge that sticks was one that reads late, for sure: no other error of it was known.

    Args:
        linear: The campaign.
        angle: Shape (T,) [rad], of the joint that moves the cylinder.
        way: Shape (T,), direction of its motion; 0 at rest.
        angle_nodes: Number of nodes.
    """
    gauges = [c for c, quantity in enumerate(linear.quantities) if quantity.kind == "gas_pressure"]
    if not gauges or np.ptp(angle) <= TRAVELS or not (np.any(way > 0) and np.any(way < 0)):
        return
    nominal = linear.replay.predict(NOMINAL)
    nodes = np.linspace(np.min(angle), np.max(angle), angle_nodes)
    raw = np.zeros((*nominal.shape, angle_nodes))
    raw[:, gauges] = (hats(angle, nodes) * way[:, None])[:, None, :]
    prior = READING_SHARE * float(np.max(np.abs(nominal[:, gauges])))
    yield Block("gauge", "reading", "angle and direction", -1, "Pa", nodes, prior), raw


def _sensors(linear: LinearisedModel, trace: Trace) -> Iterator[tuple[Block, Array]]:
    quantities = linear.quantities
    nominal = linear.replay.predict(NOMINAL)
    for c, quantity in enumerate(quantities):
        if quantity.is_drive:
            size = max(float(np.max(np.abs(nominal[:, c]))), 1e-12)
            functions = of_reading(nominal[:, c] / size)
            raw = np.zeros((*nominal.shape, functions.shape[1]))
            raw[:, c] = functions
            j, unit, prior = quantity.index, quantity.unit, READING_SHARE * size
            yield Block(f"drive {j + 1}", "reading", "load", j, unit, np.empty(0), prior, size=size), raw
    axes = [c for c, quantity in enumerate(quantities) if quantity.kind == "reflector"]
    if axes:
        of_axis = [quantities[c].axis for c in axes]
        spot = trace.reflectors.mean(axis=1)
        centre, size = spot.mean(axis=0), max(float(np.ptp(spot)), 1e-9)
        raw = np.zeros((*nominal.shape, 12))
        raw[:, axes] = in_room((spot - centre) / size)[:, of_axis]
        yield Block("tracker", "reading", "place", -1, "m", np.empty(0), TRACKER_ERROR, origin=centre, size=size), raw
        if np.ptp(trace.time) > 0:
            raw = np.zeros((*nominal.shape, 6))
            raw[:, axes] = in_time((trace.time - trace.time[0]) / HOUR)[:, of_axis]
            yield (
                Block(
                    "tracker", "reading", "time", -1, "m", np.empty(0), TRACKER_ERROR, origin=trace.time[:1], size=HOUR
                ),
                raw,
            )
        force = force_of(trace)
        largest = float(np.max(force))
        if np.ptp(force) > LEAST_FORCE:
            for r in sorted({quantities[c].index for c in axes}):
                mine = [c for c in axes if quantities[c].index == r]
                functions = under_force(force / largest)[:, [quantities[c].axis for c in mine]]
                raw = np.zeros((*nominal.shape, functions.shape[2]))
                raw[:, mine] = functions
                place = f"reflector {r + 1}"
                shape = Block(place, "reading", "force", -1, "m", np.empty(0), TRACKER_ERROR, size=largest, reflector=r)
                yield shape, raw
