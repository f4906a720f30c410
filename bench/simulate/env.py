"""The stepping interface: a Gymnasium environment, one control period a step. `gymnasium.make("bench:Bench-v0")`.

What it observes, takes and draws stands on the page `bench/environment/README.md`.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from bench.errors import NOT_SIMULATED, InputError, RobotError, unknown_name
from bench.robot.compiled import SpecEdit, read_spec
from bench.robot.folder import load_robot
from bench.simulate.action_range import ActionRange
from bench.simulate.glance import Glance
from bench.simulate.instruments import Instruments
from bench.simulate.plant import Plant
from bench.simulate.torque_plant import TorquePlant
from bench.simulate.trace import Trace

Array = NDArray[np.float64]
Observation = dict[str, Any]  # of arrays, as `gymnasium.spaces.Dict` types them
Action = dict[str, Any]

CONTROL_PERIOD = 4e-3  # [s], the sampling time of the published KR300 recordings
ROOM = 20.0  # [m], half side of the room in which positions are observed
OVERLOAD = 2.0  # readings may exceed the rating by this factor
MOST_TURNS = 4 * np.pi  # [rad] or [m], of a motor at the joint
MOST_DRAWS = 20  # of a robot in one reset. A posterior of which so many draws in a row make no model is none


@dataclass(frozen=True, eq=False)
class Drawn:
    """A robot that was drawn for one episode.

    Attributes:
        edits: Of the model, after those of the environment.
        errors: Field of `SystematicErrors` -> which of its entries are drawn here and not by the instruments, and
            their values.
        parameters: What was drawn, by name, as deviations from the robot; for `info`.
    """

    edits: tuple[SpecEdit, ...]
    errors: Mapping[str, tuple[NDArray[np.bool_], Array]]
    parameters: Mapping[str, float]


class BenchEnv(gymnasium.Env[Observation, Action]):
    """The robot on the bench.

    Action: `wrench`, shape (6,) [N, Nm], force and moment on the load point in world axes at the end of the period;
    and either `q_cmd`, shape (n,) [rad], motor angles at the end of the period, or `torque`, shape (n,) [Nm], of the
    motors at the joints during the period.

    Observation, what the instruments read at the end of the period, one entry per instrument that the robot has:
    `q_motor` (n,) [rad], `q_link` (n,) [rad], zero for joints that have no secondary encoder, `current` (n,) [A],
    `torque` (n,) [Nm], `force` (3,) [N], `moment` (3,) [Nm], `reflectors` (r, 3) [m], `gas_pressure` (1,) [Pa]; and
    `q_motor_velocity` (n,) [rad/s] if wanted. A joint that slides has m for rad and N for Nm.

    The reward is 0 and no episode ends by itself: this is a measuring bench, not a task.

    Args:
        robot: Name of a robot folder or a path to one.
        edits: Changes of the model, applied before it is compiled.
        timestep: Integration step [s]; None takes the MJCF's.
        truth: Put the noise-free `Trace` of the last instant into `info["truth"]`, and with a reset what was drawn into
            `info["parameters"]`.
        perfect_instruments: No noise, no systematic errors, no resolution.
        render_mode: None or "rgb_array".
        action: Whether motors follow angles under their servos, or put out torques.
        velocities: Observe motor velocities as a drive has them: what its encoder advanced by since the last
            observation, over the time between.
        draw: Draws the robot of each episode; None: it is always the same.

    Raises:
        InputError: An option is unknown, or velocities are wanted of a robot without motor encoders.
        RobotError: The robot is unknown, or does not compile.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / CONTROL_PERIOD)}  # noqa: RUF012  Gymnasium's

    def __init__(
        self,
        robot: str,
        edits: Iterable[SpecEdit] = (),
        timestep: float | None = None,
        truth: bool = False,
        perfect_instruments: bool = False,
        render_mode: str | None = None,
        action: Literal["position", "torque"] = "position",
        velocities: bool = False,
        draw: Callable[[np.random.Generator], Drawn] | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(f"render_mode: {render_mode!r} is not known; use None or 'rgb_array'.")
        if action not in ("position", "torque"):
            raise InputError(f"action: {unknown_name('kind of action', str(action), ['position', 'torque'])}")
        self.render_mode = render_mode
        self._plant_of = Plant if action == "position" else TorquePlant
        self._command = "q_cmd" if action == "position" else "torque"
        self._edits, self._given_timestep, self.draw = tuple(edits), timestep, draw
        self.plant: Plant = self._plant_of(load_robot(robot), self._edits, timestep)
        self._spec = read_spec(self.plant.compiled.robot) if draw else None
        self.instruments = Instruments(self.plant.compiled, None)
        self._perfect = perfect_instruments
        self._with_truth = truth
        self._renderer: Any = None
        self._glance: Glance | None = None
        self._before: tuple[Array, float] | None = None  # reading of the motors, and time until the next one [s]
        self._set_spaces(velocities)

    def _set_spaces(self, velocities: bool) -> None:
        compiled, figures = self.plant.compiled, self.plant.compiled.robot.figures
        n, r = compiled.n_joints, len(figures.reflectors)
        limits = compiled.limits
        rating = np.repeat([figures.rating.force_n, figures.rating.moment_nm], 3)
        largest_torque = self.plant.model.actuator_forcerange[compiled.at.servo, 1]
        largest_current = largest_torque / compiled.torque_constant
        angles, torques = (limits[:, 0], limits[:, 1]), (-largest_torque, largest_torque)
        ranges = {self._command: angles if self._command == "q_cmd" else torques, "wrench": (-rating, rating)}
        self._range = ActionRange(ranges)
        self.action_space = spaces.Dict({name: spaces.Box(*ends, dtype=np.float64) for name, ends in ranges.items()})
        present = {
            "q_motor": (figures.instruments.encoder, np.full(n, MOST_TURNS)),
            "q_link": (figures.instruments.link_encoder, np.full(n, MOST_TURNS)),
            "current": (figures.instruments.current, OVERLOAD * largest_current),
            "torque": (figures.instruments.torque, OVERLOAD * largest_torque),
            "force": (figures.instruments.force, OVERLOAD * rating[:3]),
            "moment": (figures.instruments.force, OVERLOAD * rating[3:]),
            "reflectors": (figures.instruments.tracker, np.full((r, 3), ROOM)),
            "gas_pressure": (figures.instruments.pressure, np.full(1, 1e9)),
        }
        self._observed = tuple(name for name, (instrument, _) in present.items() if instrument is not None)
        largest = {name: present[name][1] for name in self._observed}
        self._first_interval = (round(CONTROL_PERIOD / self.plant.timestep) - 1) * self.plant.timestep or CONTROL_PERIOD
        self._velocities = velocities
        if velocities:
            if "q_motor" not in largest:
                raise InputError("velocities: this robot has no motor encoders that they could be read from.")
            largest["q_motor_velocity"] = np.full(n, 2 * MOST_TURNS / self._first_interval)  # from one end to the other
        self.observation_space = spaces.Dict(
            {name: spaces.Box(-most, most, dtype=np.float64) for name, most in largest.items()}
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Put the robot at rest, unloaded, with new instruments; if robots are drawn, another robot.

        Args:
            seed: As of every Gymnasium environment.
            options: `{"q": angles}`, shape (n,) [rad], where the motors stand; zero unless given.

        Returns:
            First observation and `info`. Where actions are torques, `info["torque"]`, shape (n,) [Nm], is what the
            servos put out to hold the robot: torques to begin with.

        Raises:
            InputError: An option is unknown, or angles have another shape or are not finite.
            RobotError: None of `MOST_DRAWS` robots that were drawn makes a model.
        """
        super().reset(seed=seed)
        q = self._start(options or {})
        drawn = self._next_robot(q)
        self.instruments = Instruments(self.plant.compiled, None if self._perfect else self.np_random)
        if drawn and not self._perfect:
            self._take_errors(drawn)
        instant = self.plant.look()
        observation, info = self._observe(instant)
        if self._velocities:
            observation["q_motor_velocity"] = np.zeros(len(q))
            self._before = observation["q_motor"], self._first_interval
        if self._command == "torque":
            info["torque"] = instant.motor_torque[0]
        if drawn and self._with_truth:
            info["parameters"] = dict(drawn.parameters)
        return observation, info

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Advance one control period towards the commanded angles, or with the torques, and the wrench.

        Raises:
            InputError: A part of the action has another shape, is nan, or out of its range. Nothing has moved then.
        """
        command = np.asarray(action[self._command], dtype=np.float64)
        wrench = np.asarray(action["wrench"], dtype=np.float64)
        self._range.check(command, wrench)
        record = self.plant.step(command, wrench, CONTROL_PERIOD)
        if self.instruments.is_perfect:
            observation, info = self._observe(self.plant.trace_of(record))
        else:
            if self._glance is None or self._glance.instruments is not self.instruments:
                self._glance = Glance(self.instruments, self.plant.trace_of, record.shape[1], self._observed)
            observation = self._glance.read(record[0])
            info = {"truth": self.plant.trace_of(record)} if self._with_truth else {}
        if self._before is not None:
            q, interval = self._before
            observation["q_motor_velocity"] = (observation["q_motor"] - q) / interval
            self._before = observation["q_motor"], CONTROL_PERIOD
        return observation, 0.0, False, False, info

    def _start(self, options: Mapping[str, Any]) -> Array:
        """Return where the motors stand at first, shape (n,) [rad]."""
        if unknown := set(options) - {"q"}:
            raise InputError(f"reset: {unknown_name('option', str(unknown.pop()), ['q'])}")
        n = self.plant.compiled.n_joints
        try:
            q = np.array(options.get("q", np.zeros(n)), dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"reset: options['q']: is no array of {n} angles.") from error
        if q.shape != (n,) or not np.all(np.isfinite(q)):
            raise InputError(f"reset: options['q']: give {n} finite angles, not {q.tolist()}.")
        return q

    def _next_robot(self, q: Array) -> Drawn | None:
        """Put the robot at rest; draw it first, if it is drawn."""
        if self.draw is None:
            self.plant.reset(q)
            return None
        failed: Exception | None = None
        for _ in range(MOST_DRAWS):
            drawn = self.draw(self.np_random)
            edits = (*self._edits, *drawn.edits)
            try:
                plant = self._plant_of(self.plant.compiled.robot, edits, self._given_timestep, self._spec)
                plant.reset(q)
            except NOT_SIMULATED as error:
                failed = error
                continue
            self.plant = plant
            self.close()  # a renderer is of one model
            return drawn
        raise RobotError(f"none of {MOST_DRAWS} robots drawn in a row makes a model; the last: {failed}") from failed

    def _take_errors(self, drawn: Drawn) -> None:
        own = self.instruments.errors
        taken: dict[str, Any] = {
            name: np.where(which, values, getattr(own, name)) for name, (which, values) in drawn.errors.items()
        }
        self.instruments.errors = replace(own, **taken)

    def _observe(self, instant: Trace) -> tuple[Observation, dict[str, Any]]:
        reading = self.instruments.read(instant)
        values = {name: getattr(reading, name)[0] for name in self._observed}
        if "q_link" in values:
            values["q_link"] = np.nan_to_num(values["q_link"])
        if "gas_pressure" in values:
            values["gas_pressure"] = reading.gas_pressure[:1]
        return values, {"truth": instant} if self._with_truth else {}

    def render(self) -> NDArray[np.uint8] | None:
        """Return an image of the robot, shape (480, 640, 3), or None without a render mode."""
        if self.render_mode is None:
            return None
        if self._renderer is None:
            import mujoco  # the renderer needs a GL context, which only rendering should ask for

            self._renderer = mujoco.Renderer(self.plant.model, height=480, width=640)
        self._renderer.update_scene(self.plant.data)
        image: NDArray[np.uint8] = self._renderer.render()
        return image

    def close(self) -> None:
        """Free the GL context."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
