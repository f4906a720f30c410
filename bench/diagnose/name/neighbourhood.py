"""What can be tried about an extended model: a robot that has friction may have more of it at low speed, and so on."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from bench.diagnose.extend.fit import pseudo_residual
from bench.diagnose.linearise.candidates import Cause, candidates_of, causes_of
from bench.diagnose.linearise.generic import blocks_of
from bench.diagnose.linearise.lack_of_fit import are_settled, factors_of, left_by_nuisances, unexplained
from bench.diagnose.linearise.linearised_model import LinearisedModel, relinearised
from bench.diagnose.linearise.other_noise import raised, with_friction_of, with_places
from bench.diagnose.linearise.screening import Screening, Tried, screen, tried_of
from bench.diagnose.linearise.signatures import Sensitivities, Signatures
from bench.diagnose.name.models import Model, without_shape
from bench.diagnose.replay.world import World, moves
from bench.effects.effect import Effect
from bench.effects.recorded import NOTHING_RECORDED, Recorded
from bench.errors import InputError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

ROUNDS = 6  # effort: of weighing anew with other standard errors


class Renew(Protocol):
    """Returns the campaign linearised about a model, with everything that can be tried there."""

    def __call__(
        self, linear: LinearisedModel, model: Model, *, is_last: bool = False
    ) -> tuple[LinearisedModel, Tried]:
        """Return the design and what can be tried; `is_last`: nothing will be added, what is missed now is noise."""


class Neighbourhood:
    """Weighs everything that can be tried on a model, and on each model that extends it.

    Args:
        compiled: The nominal robot.
        catalogue: Effects.
        measured: Quantities that the campaign has.
        rate: Declared false-alarm rate.
        executor: Where to simulate.
        recorded: Runs and columns of the campaign.
        reach: Times what is plausible, that sizes are looked for up to.
        farther: Returns causes, with those that go farther which are told to be larger.
    """

    def __init__(
        self,
        compiled: CompiledRobot,
        catalogue: Mapping[str, Effect],
        measured: frozenset[str],
        rate: float,
        executor: Executor = SERIAL,
        recorded: Recorded = NOTHING_RECORDED,
        reach: float = 1.0,
        farther: Callable[[Sequence[Cause]], tuple[Cause, ...]] = tuple,
    ) -> None:
        self.compiled = compiled
        self.catalogue = catalogue
        self.measured = measured
        self.rate = rate
        self.executor = executor
        self.recorded = recorded
        self.reach = reach
        self.farther = farther
        self._causes: tuple[Cause, ...] = ()
        self._changes = Sensitivities(np.empty(0), ())
        self._tried: Tried | None = None
        self._tried_for: tuple[object, object] = (None, None)  # whitenings and changes

    def weighed(
        self, linear: LinearisedModel, causes: Sequence[Cause], sensitivities: Sensitivities
    ) -> tuple[LinearisedModel, Screening]:
        """Return the nominal model with everything weighed against it.

        Args:
            linear: The campaign.
            causes: What to try.
            sensitivities: What they change.
        """
        self._causes, self._changes = tuple(causes), sensitivities
        linear = self._looked_around(linear, lambda nominal: nominal.white)
        for _ in range(ROUNDS):
            factors = factors_of(linear, left_by_nuisances(linear, linear.white), linear.unexplained)
            if are_settled(factors):
                break
            linear = raised(linear, factors)
        return linear, screen(linear, linear.white, self._everything(linear), self.rate)

    def about(self, linear: LinearisedModel, model: Model, *, is_last: bool = False) -> tuple[LinearisedModel, Tried]:
        """Return the campaign linearised about an extended model, with everything that can be tried there.

        Signatures are simulated anew where effects find places that they did not find before.

        Args:
            linear: About the model before.
            model: The extended model.
            is_last: Nothing will be added any more.
        """
        fit, count = model.fit, len(linear.nuisances)
        nominal = model.linear(linear)
        world = fit.world(nominal)
        own, before = with_places(with_friction_of(nominal, world, fit.play), fit.residual), self._changes
        causes = self._causes_of(own.replay.robot(world))
        taken = {cause.key for cause in fit.causes}
        if not {cause.key for cause in causes} <= {cause.key for cause in self._causes} | taken:
            which = [i for i, nuisance in enumerate(own.nuisances) if nuisance.is_simulated]
            nuisances = tuple(own.nuisances[i] for i in which)
            known = {cause.key for cause in causes}
            self._causes = (*causes, *(cause for cause in self._causes if cause.key not in known))
            signatures = Signatures(self.compiled, own.quantities, nuisances, self._causes, world)
            self._changes = signatures.sensitivities(own.segments, self.executor)
            own = relinearised(own, which, self._changes.nuisances)
        if own.whitenings is not nominal.whitenings or self._changes is not before:
            own = self._looked_around(own, lambda other: pseudo_residual(other, fit))
        # of what the fit leaves, and once: with larger standard errors nuisances would be free to leave more, and so on
        own = raised(own, factors_of(own, own.whiten(fit.residual), own.unexplained, is_last=is_last))
        linear = without_shape(own, count)
        return linear, replace(self._everything(linear), needs=self.needs(fit.causes, world, own.replay.robot))

    def needs(
        self, found: Sequence[Cause], world: World, robot_of: Callable[[World], CompiledRobot]
    ) -> dict[Hashable, frozenset[Hashable]]:
        """Return what has no place on the nominal robot: its key -> keys of the findings that it cannot do without.

        Args:
            found: Causes of a model.
            world: The same with their sizes.
            robot_of: The robot of a world.
        """

        def there(world: World) -> set[Hashable]:
            return {cause.key for cause in self._causes_of(robot_of(world))}

        here, nominal = there(world), {cause.key for cause in self._causes_of(self.compiled)}
        new = here - nominal
        # what had a place beside earlier models alone cannot be added: it needs itself
        gone = [one.key for one in self._causes if one.key not in here | nominal]
        needs: dict[Hashable, frozenset[Hashable]] = {key: frozenset({key}) for key in gone}
        for cause, acting in zip(found, world.acting, strict=True):
            if new and moves(cause.effect):
                others = tuple(one for one in world.acting if one is not acting)
                for key in new - there(replace(world, acting=others)) - {cause.key}:
                    needs[key] = needs.get(key, frozenset()) | frozenset({cause.key})
        return needs

    def _causes_of(self, robot: CompiledRobot) -> tuple[Cause, ...]:
        known = self.measured, self.recorded, self.reach, self.compiled
        return self.farther(causes_of(self.catalogue.values(), robot, *known))

    def _looked_around(self, linear: LinearisedModel, white_of: Callable[[LinearisedModel], Array]) -> LinearisedModel:
        """Return the design with what not even everything together explains, by the instruments' standard errors."""
        plain = raised(linear, 1 / linear.inflation)
        tried = self._everything(plain)
        if not tried.entries:
            raise InputError(
                "nothing of the catalogue would leave a trace in this campaign: log motor currents or torques, a "
                "reflector, a link encoder, or the gas pressure, beside the motor angles."
            )
        least = np.maximum(unexplained(plain, white_of(plain), tried.columns, tried.prior), 1.0)
        return replace(linear, unexplained=least)

    def _everything(self, linear: LinearisedModel) -> Tried:
        """Return every cause and every free shape as a design whitens them."""
        known = (linear.whitenings, self._changes)
        if self._tried is None or self._tried_for[0] is not known[0] or self._tried_for[1] is not known[1]:
            self._tried = None  # not two of them at a time: they are the largest matrices of a diagnosis
            candidates = candidates_of(linear, self._causes, self._changes.causes)
            self._tried, self._tried_for = tried_of([*candidates, *blocks_of(linear)]), known
        return self._tried
