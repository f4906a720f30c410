"""The contract of an effect: one entry says its physics, where it may act, and how it changes model and readings.

An entry of the catalogue is a subclass of `Effect` with class attributes and one or two of these methods:

- `edit`: the effect is in the robot. It returns a change of the `MjSpec`, applied before the model is compiled.
- `encoder_error`: the effect lies between the true motor angle and what the encoder says of it; the servo follows it.
- `distort`: the effect is in another instrument. It changes readings, outside of the physics.

Errors of the recording have two more: `lateness`, for a channel that shows what was a while ago, and `log_error`, for
what was written down wrongly of a run. Whoever simulates knows how to read late and what was written.

An effect in the robot that acts as a torque may say so with `torques`: what it changes to first order then needs no
simulation. Fits always simulate.

The null value of every parameter changes nothing. Slow influences (temperatures, time) come as `Conditions`.
"""

from abc import ABC
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from bench.effects.conditions import Conditions
from bench.effects.followed import Followed, Torques
from bench.effects.parameter import Parameter as Parameter  # part of an effect
from bench.effects.recorded import Lateness, LogError, Recorded
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace

Array = NDArray[np.float64]
Family = Literal[
    "gas and cylinder",
    "drive friction",
    "transmission",
    "structure",
    "geometry and mass",
    "sensing",
    "recording",
    "own",
]
Level = Literal["machine", "recording", "run"]
Between = Literal["same", "drifts", "anew"]
IN_RECORDING = " in recording "  # between the name of a place and that of the only recording in which something acts
Values = Mapping[str, float]


@dataclass(frozen=True)
class Place:
    """Where an effect acts.

    Attributes:
        kind: "robot": as a whole (index 0, name ""); "joint": a drive; "body": a body of the MJCF; "channel": a column
            of the campaign or an instrument with several; "run": a run of the campaign.
        index: Of the drive, from 0, or MuJoCo's id of the body in the nominal model.
        name: Of the joint or body in the MJCF, of the channel or of the run.
        since: Name of the run with which it sets in; "": with the first.
        since_s: When that run begins, from the start of the campaign [s].
        about_s: Of what changes all the while, when it is what the model says, from the start of the campaign [s].
        runs: Names of the only runs in which it acts; empty: in all.
        recording: Name of the only recording in which it acts; None: in all. Whoever simulates sees to that.
    """

    kind: Literal["robot", "joint", "body", "channel", "run"]
    index: int = 0
    name: str = ""
    since: str = ""
    since_s: float = -np.inf
    about_s: float = 0.0
    runs: tuple[str, ...] = ()
    recording: str | None = None

    def __str__(self) -> str:
        is_plain = not self.since and self.recording is None
        joint = f"{'joint' if is_plain else 'drive'} {self.index + 1}"  # reports list numbers of joints
        words = {"robot": "robot", "joint": joint, "run": f"run {self.name}"}
        where = words.get(self.kind, self.name)
        if self.since:  # names of runs are unique, so these say in which recording
            return f"{where} from run {self.since} on"
        return where if self.recording is None or self.kind == "run" else f"{where}{IN_RECORDING}{self.recording}"


WHOLE = Place("robot")


class Effect(ABC):
    """One entry of the catalogue.

    Attributes:
        name: In snake_case, unique.
        family: Of the table in the documentation.
        title: What a person calls it.
        physics: Why it happens and what it does, in one to three sentences, with the formula.
        source: Literature for physics and range.
        parameters: The first is the size by which people know it.
        needs: Columns without which it cannot be seen, such as "gear_temperature" (quantities of `record.channels`).
        scatters: Whether its `edit` gives an elastic element play (a `springlength` with two ends), which leaves to
            chance where a link rests. Its evidence is then more than what its signature shows, so it is tried wherever
            something at its place comes near the best cause.
        holds: Name of the parameter that is a level up to which it holds a link, as Coulomb friction of links does, and
            leaves as much to chance; "" for none.
        level: "machine": it is in the robot or its instruments all the while; "recording": a channel does not say what
            its name and time stamp promise; "run": it holds for one run, or changes in the course of the session.
        between: What becomes of it between two recordings of a machine: it is the "same" in all of them; it is another
            one "anew" each time, as a payload is, and looked for in each recording by itself, as errors of the level
            "recording" or "run" are; or it "drifts", so it is looked for in all of them together and in each.
        advice: What a person should look at where it is found; "" where that is the part which the title names.
        motion: Which motion shows it where a campaign does not, in words; "" where that depends.
        depends_on_conditions: Whether its `edit` is another one at other temperatures.
        covers: Names of effects that say a part of it: where it is found, these are not unseen.
        only_if_told: Whether it is looked for only where a first pass over moving data has it: a curve of several sizes
            holds much of what other effects do, and that is weighed there.
        moves_with: Names of effects at the same place that what moves this one may move by as large a share. Its first
            parameter is a share of a level that the model has then; so is that of those among them that say the same.
        is_additive: Whether its `torques` are the same where the effect acts already; those of an effect that scales a
            figure grow with that figure.
    """

    name: ClassVar[str]
    family: ClassVar[Family]
    title: ClassVar[str]
    physics: ClassVar[str]
    source: ClassVar[str]
    parameters: tuple[Parameter, ...]  # of the class; of an effect that is made from data, of the instance
    needs: ClassVar[tuple[str, ...]] = ()
    scatters: ClassVar[bool] = False
    holds: ClassVar[str] = ""
    level: ClassVar[Level] = "machine"
    between: ClassVar[Between] = "same"
    advice: ClassVar[str] = ""
    motion: ClassVar[str] = ""
    depends_on_conditions: ClassVar[bool] = False
    is_additive: ClassVar[bool] = False
    only_if_told: ClassVar[bool] = False
    covers: ClassVar[tuple[str, ...]] = ()
    moves_with: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        """Let a class with another `edit` than its base not inherit what that said of torques."""
        if "edit" in vars(cls) and "torques" not in vars(cls):
            cls.torques = Effect.torques  # type: ignore[method-assign]
            cls.is_additive = False

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return where it may act on this robot; empty where the robot has no such part."""
        return (WHOLE,)

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return where it may act on this robot in a campaign; by default wherever it may act on the robot."""
        return self.places(compiled)

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameters with the ranges and units that hold at a place; by default `parameters`.

        Names, signs and shapes are the same: a light drive has less friction in Nm than a heavy one, and can lose less.
        """
        return self.parameters

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        """Return the change of the model under some conditions, or None if the effect is not in the robot.

        It is applied after a payload was bolted on.
        """
        return None

    def there_already(self, compiled: CompiledRobot, place: Place) -> Mapping[str, float]:
        """Return how much of each of its sizes that have one sign a model has already at a place, and could lose.

        By default what its figures hold as fitted. With a size below none `edit` takes as much away.
        """
        where = place.name or "robot"
        there: dict[str, float] = {}
        for one in compiled.robot.figures.fitted.effects:
            if one.effect == self.name and one.place == where:
                for p in self.parameters:
                    if p.name in one.values and not (p.signed or p.is_shape):
                        there[p.name] = there.get(p.name, 0.0) + one.values[p.name] - p.null
        return there

    def phase(self, place: Place, conditions: Conditions) -> Hashable:
        """Return what decides, of the time at which it acts, what `edit` does; by default nothing.

        Conditions of equal temperatures and equal phase have the same model.
        """
        return ()

    def torques(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        """Return the torques that the effect adds to the drive at its place, to first order in its sizes.

        None, as by default: it has to be simulated, in any case or along what this robot did.
        """
        return None

    def averaged(self, place: Place, values: Values, followed: Followed) -> Torques | None:
        """Return what the torques of its drive have more where they are averaged along the motion than in its middle.

        None, as by default: it does not change within what a reading averages.

        Args:
            place: Where it acts.
            values: Parameters.
            followed: What a robot did in which it acts.
        """
        return None

    def encoder_error(self, place: Place, values: Values, q: Array, velocity: Array) -> Array | None:
        """Return reading minus true motor angle, shape (T, n) [rad], or None if the encoder is right.

        Args:
            place: Where it acts.
            values: Parameters.
            q: Shape (T, n) [rad], true motor angles.
            velocity: Shape (T, n) [rad/s].
        """
        return None

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        """Return what the instruments show instead of `reading`; by default the same.

        Args:
            place: Where it acts.
            values: Parameters.
            reading: What they would show.
            trace: The truth at the same instants; `trace.time` counts from the start of the campaign.
            conditions: During the run.
        """
        return reading

    def lateness(self, place: Place, values: Values) -> Lateness | None:
        """Return what the recording shows late, or None if everything is as old as its time stamp says."""
        return None

    def log_error(self, place: Place, values: Values, run: str) -> LogError | None:
        """Return how the truth of a run differs from what was written down, or None if that is right.

        Args:
            place: Where it acts.
            values: Parameters.
            run: Name of the run.
        """
        return None

    def complete(self, values: Values) -> dict[str, float]:
        """Return all parameters, those not given at their null value.

        Raises:
            InputError: An unknown parameter.
        """
        from bench.errors import InputError, unknown_name

        known = {parameter.name: parameter.null for parameter in self.parameters}
        for name in values:
            if name not in known:
                raise InputError(f"effect {self.name!r}: {unknown_name('parameter', name, known)}")
        return known | dict(values)


@dataclass(frozen=True)
class Acting:
    """An effect that acts at a place with certain values."""

    effect: Effect
    place: Place
    values: Values

    def __str__(self) -> str:
        where = "" if self.place == WHOLE else f" ({self.place})"
        sizes = ", ".join(
            f"{p.name} {self.values[p.name]:.4g} {p.unit}".strip()
            for p in self.effect.parameters
            if p.name in self.values
        )
        return f"{self.effect.name}{where}: {sizes}"
