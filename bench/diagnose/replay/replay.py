"""Replay: the model repeats a campaign, and says what every instrument should have shown.

The prediction of a `World` (`world.py`) is a simulation in MuJoCo each time; nothing here is a linearisation. How the
robot of a world moves is `motion_replay.py`'s; here its instruments are read.
"""

from dataclasses import replace

import numpy as np

from bench.diagnose.replay.courses import count_of, true_conditions
from bench.diagnose.replay.given import EARLIER, LABEL, said_before
from bench.diagnose.replay.known import known_value
from bench.diagnose.replay.late import read_late
from bench.diagnose.replay.levels import world_in
from bench.diagnose.replay.motion_replay import MotionReplay
from bench.diagnose.replay.perfect_instruments import distorted, ideal_reading
from bench.diagnose.replay.quantities import Quantity, predicted
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import World
from bench.effects.effect import Effect
from bench.effects.levels import acts_in
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.patched import Structure
from bench.robot.recent import Recent
from bench.simulate.prescribed import TOLERANCE
from bench.simulate.trace import Trace

MOST_EARLIER = 16  # effort: motions kept; a world with a delay of each of six drives asks for six


class Replay(MotionReplay):
    """A campaign, ready to be repeated by worlds. What the nominal robot's figures hold as fitted acts in all of them.

    Args:
        compiled: The nominal robot.
        segments: The campaign.
        quantities: What is predicted.
        tolerance: Of the torques on the links, where a balance counts as found.
        structure: The robot, ready to be changed, where another replay has it already.
    """

    def __init__(
        self,
        compiled: CompiledRobot,
        segments: tuple[Segment, ...],
        quantities: tuple[Quantity, ...],
        tolerance: float = TOLERANCE,
        structure: Structure | None = None,
    ) -> None:
        super().__init__(compiled, segments, tolerance, structure)
        self.quantities = quantities
        self._earlier: Recent[float, MotionReplay] = Recent(MOST_EARLIER)  # by how many seconds

    def of(self, segments: tuple[Segment, ...]) -> "Replay":
        """Return the replay of other segments, with the same quantities, by the same robot."""
        return Replay(self.compiled, segments, self.quantities, self._tolerance, self._structure)

    @property
    def shape(self) -> tuple[int, int]:
        """Instants that are read, and quantities."""
        return sum(count_of(segment) for segment in self.segments), len(self.quantities)

    def predict(self, world: World) -> Array:
        """Return what instruments show in a world, shape (T, c), segment after segment.

        Raises:
            ConvergenceError: The model finds no balance.
            RobotError: The effect does not fit the model.
        """
        return self.read(world, self.trace(world))

    def read(self, world: World, trace: Trace) -> Array:
        """Return what the instruments of a world show of a motion, shape (T, c), segment after segment."""
        trace = self._with_late_torques(world, trace)
        trace = replace(trace, motor_torque=trace.motor_torque + self.moved(world).excess - self._averaged(world))
        given, world = world, self.whole(world)
        if not world.is_told_apart:
            shown = self._read(world, self.segments, trace)
        else:
            shown = np.empty(self.shape)
            for recording, members in self._recordings.items():
                segments = tuple(self.segments[i] for i in members)
                rows = np.concatenate([np.arange(self._rows[i].start, self._rows[i].stop) for i in members])
                shown[rows] = self._read(world_in(world, recording), segments, trace[rows])
        if any(quantity.is_known for quantity in self.quantities):
            self._say_known(shown, given, trace)
        return shown

    def _averaged(self, world: World) -> Array | float:
        """Return what effects that change within a bin add to averaged torques, shape (T, n) [Nm] or [N]."""
        fine = [one for one in self.whole(world).acting if type(one.effect).averaged is not Effect.averaged]
        if not fine:
            return 0.0
        added = np.zeros((self.shape[0], self.compiled.n_joints))
        for course, followed in self.followed(world):
            for one in fine:
                if acts_in(one.place, course.recording) and (
                    more := one.effect.averaged(one.place, one.values, followed)
                ):
                    added[course.rows, one.place.index] += more.motor + more.link
        return added

    def _with_late_torques(self, world: World, trace: Trace) -> Trace:
        """Return a motion with the torques of drives that are read late as they were before: along an earlier motion.

        Between the instants that are read a torque may jump with the acceleration, so it is not interpolated. At rest
        nothing changes.
        """
        late = [
            (one, acting.place)
            for acting in self.whole(world).acting
            if (one := acting.effect.lateness(acting.place, acting.values)) and one.field == "motor_torque"
        ]
        if not late:
            return trace
        seconds = np.zeros_like(trace.motor_torque)  # by which each is late
        for one, place in late:
            for segment, rows in zip(self.segments, self._rows, strict=True):
                if acts_in(place, segment.recording):
                    seconds[rows, slice(None) if one.drive is None else one.drive] += one.seconds
        torque, now = trace.motor_torque.copy(), self.trace(world).motor_torque
        for late_by in np.unique(seconds[seconds != 0]):
            change = self._earlier_by(float(late_by)).trace(world).motor_torque - now
            torque += np.where(seconds == late_by, change, 0.0)
        return replace(trace, motor_torque=torque)

    def _earlier_by(self, seconds: float) -> MotionReplay:
        """Return the motion some time before each instant."""

        def motion() -> MotionReplay:
            segments = tuple(segment.earlier(seconds) for segment in self.segments)
            return MotionReplay(self.compiled, segments, self._tolerance, self._structure, near=self)

        return self._earlier.get(seconds, motion)

    def _read(self, world: World, segments: tuple[Segment, ...], trace: Trace) -> Array:
        """Return the same for segments in which all of a world acts, but for what is known besides."""
        late = [acting.effect.lateness(acting.place, acting.values) for acting in world.acting]
        trace = read_late(self.compiled, segments, trace, [one for one in late if one and one.field != "motor_torque"])
        ideal = ideal_reading(self.compiled, trace)
        reading = world.read(ideal, lambda reading, acting: distorted(reading, segments, trace, acting))
        return predicted(self.quantities, reading)

    def _say_known(self, values: Array, world: World, trace: Trace) -> None:
        """Write what the lab knows besides, as it is in a world; errors of the recording are not in it."""
        of_machine = self.whole(world).of_machine
        reading = distorted(ideal_reading(self.compiled, trace), self.segments, trace, of_machine)
        for segment, mine in zip(self.segments, self._rows, strict=True):
            if segment.label == LABEL:
                values[mine, self.quantities.index(EARLIER)] = said_before(world.deviations, len(segment))
        for course in self._courses(world):
            compiled, rows = self._robot(world, true_conditions(world, course)), course.rows
            for c, quantity in enumerate(self.quantities):
                if quantity.is_known and quantity != EARLIER:
                    known = quantity, compiled, trace.gas_force[rows], reading.gas_temperature[rows]
                    values[rows, c] = known_value(*known)
