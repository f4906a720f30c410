"""Let a policy drive the environment, and keep what was read, what was true, and a film of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bench.simulate.env import CONTROL_PERIOD, BenchEnv, Observation
from bench.simulate.instruments import Reading
from bench.simulate.policy import Sitting, Step
from bench.simulate.trace import Array, Trace

FILM_PERIOD = 0.1  # [s], how often the film keeps an instant

Progress = Callable[[float], None]


@dataclass
class Log:
    """What happened while a policy drove: one entry per step that was read, and one per frame of the film.

    Attributes:
        steps: The steps that were read; each has a mark.
        instants: The truth at their ends.
        observations: What the instruments read there.
        payload_kg: What was bolted to the load point.
        film, film_observations: The same at a low rate, read or not.
        events: (time [s], words).
    """

    steps: list[Step] = field(default_factory=list)
    instants: list[Trace] = field(default_factory=list)
    observations: list[Observation] = field(default_factory=list)
    payload_kg: list[float] = field(default_factory=list)
    film: list[Trace] = field(default_factory=list)
    film_observations: list[Observation] = field(default_factory=list)
    events: list[tuple[float, str]] = field(default_factory=list)
    _rows: dict[str, list[int]] = field(default_factory=dict, repr=False)  # of the first `_counted` steps
    _counted: int = 0

    @property
    def run_names(self) -> tuple[str, ...]:
        """Names of the runs, in the order in which they began."""
        return tuple(dict.fromkeys(step.mark.run for step in self.steps if step.mark))

    def rows(self, run: str) -> list[int]:
        """Return which of the readings belong to a run."""
        for i, step in enumerate(self.steps[self._counted :], start=self._counted):
            if step.mark:
                self._rows.setdefault(step.mark.run, []).append(i)
        self._counted = len(self.steps)
        return self._rows.get(run, [])


def drive(env: BenchEnv, sitting: Sitting, begin: float, log: Log, progress: Progress) -> float:
    """Drive one sitting on an environment that was just reset; return the time at its end [s].

    Args:
        env: At rest at the start of the sitting.
        sitting: What to do.
        begin: Session time at its start [s].
        log: What happens is added to it.
        progress: Called with the share of this sitting that is done.
    """
    steps = list(sitting.steps)
    every = round(FILM_PERIOD / CONTROL_PERIOD)
    waited = 0.0
    for i, step in enumerate(steps):
        if step.move_reflector:
            env.instruments.move_reflector()
        observation, _, _, _, info = env.step({"q_cmd": step.q_cmd, "wrench": step.wrench})
        seen: Trace = info["truth"]
        env.plant.wait(step.wait_s)
        waited += step.wait_s
        if not (step.mark or step.event or i % every == 0):
            continue
        instant = replace(seen, time=seen.time + begin + waited)
        if step.event:
            log.events.append((float(instant.time[0]), step.event))
        if step.mark:
            log.steps.append(step)
            log.instants.append(instant)
            log.observations.append(observation)
            log.payload_kg.append(sitting.payload_kg)
        if i % every == 0:
            log.film.append(instant)
            log.film_observations.append(observation)
            progress(i / len(steps))
    return begin + waited + float(env.plant.data.time)


def stacked(observations: Sequence[Observation], instants: Sequence[Trace]) -> Reading:
    """Return observations as one reading; what no instrument reads is nan."""

    def stack(name: str, like: Array) -> Array:
        if name not in observations[0]:
            return np.full((len(observations), *like.shape), np.nan)
        return np.stack([observation[name] for observation in observations])

    first = instants[0]
    return Reading(
        time=np.concatenate([instant.time for instant in instants]),
        q_motor=stack("q_motor", first.q[0]),
        q_link=stack("q_link", first.q[0]),
        current=stack("current", first.q[0]),
        torque=stack("torque", first.q[0]),
        force=stack("force", first.wrench[0, :3]),
        moment=stack("moment", first.wrench[0, 3:]),
        reflectors=stack("reflectors", first.reflectors[0]),
        gas_pressure=stack("gas_pressure", first.time)[:, 0],
        gas_temperature=np.full(len(observations), np.nan),
    )
