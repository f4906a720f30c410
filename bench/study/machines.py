"""Several recordings of one messy machine: what stays, what is set up anew each time, and what is hidden."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Literal
from zlib import crc32

import numpy as np

from bench.effects.effect import Acting, Effect, Place
from bench.errors import ConvergenceError
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Campaign
from bench.record.joined import joined
from bench.study.labs import Lab, Setup, machine_components
from bench.study.limits import Way
from bench.study.make import TRIES, Sized, sized
from bench.study.outcome import Name
from bench.study.plan import Trial
from bench.study.worlds import LARGEST, OF_SECOND, SMALLEST, MachineWorld, catalogue_in, surroundings_of

# "none": nothing; "machine": an effect of the machine in all recordings; "one": an effect in one of them alone;
# "unchanged" and "changed": two recordings to compare, without and with an effect that comes between them
Kind = Literal["none", "machine", "one", "unchanged", "changed"]


@dataclass(frozen=True)
class MachineTrial:
    """One machine that is recorded several times.

    Attributes:
        kind: What is hidden.
        number: Of its kind, from 0.
        recordings: How many.
        effects: Names of what is hidden where anything is; empty: whatever can act takes turns.
        world: Messy, of the first plant or of the second.
    """

    kind: Kind
    number: int
    recordings: int
    effects: tuple[str, ...] = ()
    world: MachineWorld = "messy"

    @property
    def name(self) -> str:
        """Unique in a study."""
        plain = f"{self.kind} {self.number + 1}"
        return plain if self.world == "messy" else f"{self.world} {plain}"

    def rng(self, seed: int) -> np.random.Generator:
        """Return the random numbers of this machine in a study with a seed."""
        return np.random.default_rng([seed, crc32(self.name.encode())])


@dataclass(frozen=True, eq=False)
class Machine:
    """Recordings of one machine.

    Attributes:
        recordings: Name -> campaign, in order.
        hidden: What is to be found; None: nothing.
        only: Name of the only recording in which it acts; "": in all.
        everywhere: What acts in all recordings, small things too.
        own: Recording -> what acts in that one alone.
    """

    recordings: dict[str, Campaign]
    hidden: Sized | None
    only: str
    everywhere: tuple[Acting, ...]
    own: dict[str, tuple[Acting, ...]]

    @property
    def campaign(self) -> Campaign:
        """All recordings as one campaign."""
        return joined(self.recordings)

    @property
    def truth(self) -> frozenset[Name]:
        """Every cause that acts, by the names that a verdict may give it.

        What acts everywhere may be named for the machine or for each recording.
        """
        found = {_name(one) for one in self.everywhere}
        for recording, own in self.own.items():
            found |= {_name(one, recording) for one in (*own, *self.everywhere)}
        return frozenset(found)


def machine_of(trial: MachineTrial, setup: Setup, seed: int) -> Machine:
    """Return the recordings of a trial; where a machine finds no rest, another one is drawn.

    Args:
        trial: What to hide; of the kinds "none", "machine" and "one".
        setup: Of the ordinary lab, for detection limits.
        seed: Of the study.

    Raises:
        ConvergenceError: None of several draws finds a rest.
    """
    rng = trial.rng(seed)
    for _ in range(TRIES - 1):
        with suppress(ConvergenceError):
            return _drawn(trial, setup, rng)
    return _drawn(trial, setup, rng)


def components_in(world: MachineWorld, setup: Setup) -> Iterator[tuple[Effect, Place]]:
    """Yield every effect of the machine at every place where it can act in a world."""
    yield from machine_components(catalogue_in(world, setup.catalogue), setup.lab, setup.compiled)


def recorded(
    lab: Lab, acting: tuple[Acting, ...], rng: np.random.Generator, machine: int, world: MachineWorld = "messy"
) -> Campaign:
    """Return a recording of the machine with a seed, in which effects act, by the plant of a world."""
    own = np.random.default_rng(machine)
    if world in OF_SECOND:
        return lab.hide_in_second(acting, rng, rests=world == "resting", machine=own)
    robot, session = lab.robot(), lab.scenario()
    known = hide_campaign(robot, session, acting, rng, without=lab.without, channels=lab.channels, machine=own)
    return known.campaign


def _drawn(trial: MachineTrial, setup: Setup, rng: np.random.Generator) -> Machine:
    names = tuple(f"day{k + 1}" for k in range(trial.recordings))
    hidden = None if trial.kind == "none" else _hidden(trial, setup, rng)
    only = str(rng.choice(names)) if trial.kind == "one" else ""
    new = (hidden.acting,) if hidden else ()
    known = tuple(components_in(trial.world, setup))
    lasting = tuple((effect, place) for effect, place in known if effect.between == "same")
    everywhere = tuple(one for one, _ in surroundings_of("messy", new, lasting, setup.compiled, rng))
    own = {name: tuple(_set_up_anew(trial.world, setup, hidden, rng)) for name in names}
    if hidden and only:
        own[only] = (*own[only], hidden.acting)
    elif hidden:
        everywhere = (*everywhere, hidden.acting)
    machine = int(rng.integers(2**31))
    campaigns = {name: recorded(setup.lab, (*everywhere, *own[name]), rng, machine, trial.world) for name in names}
    return Machine(campaigns, hidden, only, everywhere, own)


def _hidden(trial: MachineTrial, setup: Setup, rng: np.random.Generator) -> Sized:
    """Return what is hidden, at three times the detection limit of a single recording."""
    able = trial.effects or tuple(effect.name for effect in _able(trial, setup))
    name = able[int(rng.integers(len(able)))]
    single = Trial(trial.name, "single", (name,), int(rng.integers(2**16)), "three limits", world=trial.world)
    return sized(setup.catalogue[name], single, setup, rng)


def _able(trial: MachineTrial, setup: Setup) -> Iterator[Effect]:
    """Yield effects that the machine has in all recordings, or that can act in one recording alone."""
    of_machine = {effect.name for effect, _ in components_in(trial.world, setup)}
    in_one = trial.kind == "one"
    for effect in catalogue_in(trial.world, setup.catalogue).values():
        is_error = effect.level == "recording" and bool(setup.lab.places(effect, setup.compiled))
        if (in_one and is_error) or (effect.name in of_machine and (in_one or effect.between == "same")):
            yield effect


def _set_up_anew(world: MachineWorld, setup: Setup, hidden: Sized | None, rng: np.random.Generator) -> Iterator[Acting]:
    """Yield what is another one in each recording, as large as the small things of a messy arm."""
    taken = _name(hidden.acting) if hidden else None
    for effect, place in components_in(world, setup):
        if effect.between != "same" and (effect.name, str(place)) != taken:
            size = float(rng.uniform(SMALLEST, LARGEST))
            yield Way.draw(effect, place, setup.compiled, rng).at(size, setup.compiled)


def _name(acting: Acting, recording: str | None = None) -> Name:
    return acting.effect.name, str(replace(acting.place, recording=recording))
