"""The stepping interface: a Gymnasium environment, one control period a step. `gymnasium.make("bench:Bench-v0")`."""

from collections.abc import Iterable
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from bench.errors import InputError, unknown_name
from bench.robot.compiled import SpecEdit
from bench.robot.folder import load_robot
from bench.simulate.glance import Glance
from bench.simulate.instruments import Instruments
from bench.simulate.plant import Plant, Trace

Array = NDArray[np.float64]
Observation = dict[str, Any]  # of arrays, as `gymnasium.spaces.Dict` types them
Action = dict[str, Any]

CONTROL_PERIOD = 4e-3  # [s], the sampling time of the published KR300 recordings
ROOM = 20.0  # [m], half side of the room in which positions are observed
OVERLOAD = 2.0  # readings may exceed the rating by this factor


class BenchEnv(gymnasium.Env[Observation, Action]):
    """The robot on the bench.

    Action: `q_cmd`, shape (n,) [rad], motor angles at the end of the period, and `wrench`, shape (6,) [N, Nm], force
    and moment on the load point in world axes at the end of the period.

    Observation, what the instruments read at the end of the period, one entry per instrument that the robot has:
    `q_motor` (n,) [rad], `q_link` (n,) [rad], zero for joints that have no secondary encoder, `current` (n,) [A],
    `torque` (n,) [Nm], `force` (3,) [N], `moment` (3,) [Nm], `reflectors` (r, 3) [m], `gas_pressure` (1,) [Pa]. A
    joint that slides has m for rad and N for Nm.

    The reward is 0 and no episode ends by itself: this is a measuring bench, not a task.

    Args:
        robot: Name of a robot folder or a path to one.
        edits: Sensitivities of the model, applied before it is compiled.
        timestep: Integration step [s]; None takes the MJCF's.
        truth: Put the noise-free `Trace` of the last instant into `info["truth"]`.
        perfect_instruments: No noise, no systematic errors, no resolution.
        render_mode: None or "rgb_array".
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
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(f"render_mode: {render_mode!r} is not known; use None or 'rgb_array'.")
        self.render_mode = render_mode
        self.plant = Plant(load_robot(robot), edits, timestep)
        self.instruments = Instruments(self.plant.compiled, None)
        self._perfect = perfect_instruments
        self._with_truth = truth
        self._renderer: Any = None
        self._glance: Glance | None = None
        compiled, figures = self.plant.compiled, self.plant.compiled.robot.figures
        n, r = compiled.n_joints, len(figures.reflectors)
        limits = compiled.limits
        rating = np.repeat([figures.rating.force_n, figures.rating.moment_nm], 3)
        self.action_space = spaces.Dict(
            {
                "q_cmd": spaces.Box(limits[:, 0], limits[:, 1], dtype=np.float64),
                "wrench": spaces.Box(-rating, rating, dtype=np.float64),
            }
        )
        largest_torque = self.plant.model.actuator_forcerange[compiled.at.servo, 1]
        largest_current = largest_torque / compiled.torque_constant
        present = {
            "q_motor": (figures.instruments.encoder, np.full(n, 4 * np.pi)),
            "q_link": (figures.instruments.link_encoder, np.full(n, 4 * np.pi)),
            "current": (figures.instruments.current, OVERLOAD * largest_current),
            "torque": (figures.instruments.torque, OVERLOAD * largest_torque),
            "force": (figures.instruments.force, OVERLOAD * rating[:3]),
            "moment": (figures.instruments.force, OVERLOAD * rating[3:]),
            "reflectors": (figures.instruments.tracker, np.full((r, 3), ROOM)),
            "gas_pressure": (figures.instruments.pressure, np.full(1, 1e9)),
        }
        self._observed = tuple(name for name, (instrument, _) in present.items() if instrument is not None)
        self.observation_space = spaces.Dict(
            {name: spaces.Box(-present[name][1], present[name][1], dtype=np.float64) for name in self._observed}
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Put the robot at rest, unloaded, at `options["q"]` [rad] (default: zero), with new instruments."""
        super().reset(seed=seed)
        options = options or {}
        if unknown := set(options) - {"q"}:
            raise InputError(f"reset: {unknown_name('option', str(unknown.pop()), ['q'])}")
        q = np.array(options.get("q", np.zeros(self.plant.compiled.n_joints)), dtype=np.float64)
        self.instruments = Instruments(self.plant.compiled, None if self._perfect else self.np_random)
        self.plant.reset(q)
        return self._observe(self.plant.look())

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Advance one control period towards the commanded angles and wrench."""
        record = self.plant.step(action["q_cmd"], action["wrench"], CONTROL_PERIOD)
        if self.instruments.is_perfect:
            observation, info = self._observe(self.plant.trace_of(record))
            return observation, 0.0, False, False, info
        if self._glance is None or self._glance.instruments is not self.instruments:
            self._glance = Glance(self.instruments, self.plant.trace_of, record.shape[1], self._observed)
        info = {"truth": self.plant.trace_of(record)} if self._with_truth else {}
        return self._glance.read(record[0]), 0.0, False, False, info

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
