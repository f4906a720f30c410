"""What can be tried about an extended model: a robot that has friction may have more of it at low speed, and so on."""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from types import MappingProxyType

import numpy as np

from bench.diagnose.extend.fit import pseudo_residual
from bench.diagnose.linearise.candidates import LARGER, Candidate, Cause, as_far_as_told, candidates_of, causes_of
from bench.diagnose.linearise.generic import Block, blocks_of
from bench.diagnose.linearise.lack_of_fit import are_settled, factors_of, left_by_nuisances, unexplained
from bench.diagnose.linearise.linearised_model import LinearisedModel, relinearised
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.other_noise import raised, with_friction_of, with_places, with_repeats, with_ringing
from bench.diagnose.linearise.repeated_rests import SHARES, repeating_share, repeating_visits
from bench.diagnose.linearise.screening import Screening, Tried, ranked, screen, tried_of
from bench.diagnose.linearise.signatures import Sensitivities, Signatures
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.models import Model, without_shape
from bench.diagnose.replay.world import World, moves
from bench.effects.effect import Effect
from bench.effects.recorded import NOTHING_RECORDED, Recorded
from bench.errors import InputError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

Needs = dict[Hashable, frozenset[Hashable]]  # key of a cause -> those of findings that it cannot do without
WhiteOf = Callable[[LinearisedModel], Array]  # residual of a model, nuisances at zero, whitened
ROUNDS = 6  # effort: of weighing anew with other standard errors


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
        told: What a first pass has: name of an effect and index of a drive -> its size.
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
        told: Mapping[tuple[str, int], float] = MappingProxyType({}),
    ) -> None:
        self.compiled = compiled
        self.catalogue = catalogue
        self.measured = measured
        self.rate = rate
        self.executor = executor
        self.recorded = recorded
        self.reach = reach
        self.told = told
        self._causes: tuple[Cause, ...] = ()
        self._changes = Sensitivities(np.empty(0), ())
        self._tried: Tried | None = None
        self._tried_for: tuple[object, object] = (None, None)  # whitenings and changes
        self._repeats = 0.0  # share of friction at rest that repeats if nothing acts
        self._threshold = LEAST

    def weighed(
        self, linear: LinearisedModel, causes: Sequence[Cause], sensitivities: Sensitivities
    ) -> tuple[LinearisedModel, Screening]:
        """Return the nominal model with everything weighed against it.

        Args:
            linear: The campaign.
            causes: What to try.
            sensitivities: What they change.
        """
        self._causes, self._changes = self._as_told(causes), sensitivities
        linear, screening = self._screened(linear)
        self._repeats, self._threshold = linear.scatter.repeats, screening.threshold
        other = self._repeating(linear, lambda nominal: nominal.white)
        return (linear, screening) if other is linear else self._screened(other)

    def about(self, linear: LinearisedModel, model: Model, *, is_last: bool = False) -> tuple[LinearisedModel, Needs]:
        """Return the campaign linearised about an extended model, and what has a place beside its findings alone.

        Signatures are simulated anew where effects find places that they did not find before.

        Args:
            linear: About the model before.
            model: The extended model.
            is_last: Nothing will be added any more.
        """
        fit, count = model.fit, len(linear.nuisances)
        nominal = model.linear(linear)
        world = fit.world(nominal)
        own, before = with_ringing(with_friction_of(nominal, world, fit.play), fit.residual), self._changes
        own = with_places(own, fit.residual)
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
        own = self._repeating(own, lambda other: pseudo_residual(other, fit))
        if own.whitenings is not nominal.whitenings or self._changes is not before:
            own = self._looked_around(own, lambda other: pseudo_residual(other, fit))
        # of what the fit leaves, and once: with larger standard errors nuisances would be free to leave more, and so on
        own = raised(own, factors_of(own, own.whiten(fit.residual), own.unexplained, is_last=is_last))
        return without_shape(own, count), self.needs(fit.causes, world, own.replay.robot)

    def needs(self, found: Sequence[Cause], world: World, robot_of: Callable[[World], CompiledRobot]) -> Needs:
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
        needs: Needs = {key: frozenset({key}) for key in gone}
        for cause, acting in zip(found, world.acting, strict=True):
            if new and moves(cause.effect):
                others = tuple(one for one in world.acting if one is not acting)
                for key in new - there(replace(world, acting=others)) - {cause.key}:
                    needs[key] = needs.get(key, frozenset()) | frozenset({cause.key})
        return needs

    def _causes_of(self, robot: CompiledRobot) -> tuple[Cause, ...]:
        known = self.measured, self.recorded, self.reach, self.compiled
        return self._as_told(causes_of(self.catalogue.values(), robot, *known, told=self.told))

    def _as_told(self, causes: Sequence[Cause]) -> tuple[Cause, ...]:
        return as_far_as_told(causes, self.told, LARGER)

    def _screened(self, linear: LinearisedModel) -> tuple[LinearisedModel, Screening]:
        """Return the nominal model with the standard errors that it asks for, and everything weighed against it."""
        linear = self._looked_around(linear, lambda nominal: nominal.white)
        for _ in range(ROUNDS):
            factors = factors_of(linear, left_by_nuisances(linear, linear.white), linear.unexplained)
            if are_settled(factors):
                break
            linear = raised(linear, factors)
        return linear, screen(linear, linear.white, self.everything(linear), self.rate)

    def _repeating(self, linear: LinearisedModel, white_of: WhiteOf) -> LinearisedModel:
        """Return the design in which as much of the friction at rest repeats as is most probable, whatever acts.

        What acts between two visits of a pose looks like friction that does not repeat, and hides in it. So the share
        that repeats if nothing acts is held against that which the best single thing leaves, looked for where all
        repeats: each with its evidence, and the thing with its prior odds.
        """
        if self._repeats >= SHARES[-1] or not repeating_visits(linear.segments):
            return linear
        most = with_repeats(linear, SHARES[-1])
        left = linear.split(most.unwhiten(self._best_beside(most, white_of(most))[1][:, None])[:, :, 0])
        known = linear.replay.compiled, linear.weighed, linear.responses, linear.quantities, linear.scatter
        plain, other = with_repeats(linear, self._repeats), with_repeats(linear, repeating_share(*known, left))
        if other.scatter.repeats <= self._repeats:
            return plain
        return max((plain, other), key=lambda one: self._best_beside(one, white_of(one))[0])

    def _best_beside(self, linear: LinearisedModel, white: Array) -> tuple[float, Array]:
        """Return the log evidence of a model or of that with the best single thing beside it, and what this leaves.

        Args:
            linear: The campaign about the model.
            white: Shape (m,), its residual with nuisances at zero; what is left has the same shape.
        """
        nuisances, tried = Nuisances(linear.jacobian), self.everything(linear)
        marginal = nuisances.products(white, tried.columns)
        alone = float(np.sum(linear.log_determinants)) - marginal.misfit / 2 - nuisances.log_determinant
        best = ranked(marginal, tried.entries)[0]
        if best.log_evidence > self._threshold:
            sizes, _ = marginal.sizes(best.columns, best.what.plausible)
            white = white - tried.columns.matrix[:, best.columns] @ sizes
        return alone + max(best.log_evidence - self._threshold, 0.0), left_by_nuisances(linear, white)

    def _looked_around(self, linear: LinearisedModel, white_of: WhiteOf) -> LinearisedModel:
        """Return the design with what not even everything together explains, by the instruments' standard errors."""
        plain = raised(linear, 1 / linear.inflation)
        tried = self.everything(plain)
        if not tried.entries:
            raise InputError(
                "nothing of the catalogue would leave a trace in this campaign: log motor currents or torques, a "
                "reflector, a link encoder, or the gas pressure, beside the motor angles."
            )
        least = np.maximum(unexplained(plain, white_of(plain), tried.columns, tried.prior), 1.0)
        return replace(linear, unexplained=least)

    def everything(self, linear: LinearisedModel) -> Tried:
        """Return every cause and every free shape as a design whitens them, and let go of those of another design.

        They are the largest matrix of a diagnosis (0.9 GB of 320 s of two recordings with seven drives).
        """
        known = (linear.whitenings, self._changes)
        if self._tried is None or self._tried_for[0] is not known[0] or self._tried_for[1] is not known[1]:
            if self._tried:
                self._tried.columns.let_go()
            self._tried = None
            every: Iterable[Candidate | Block] = chain(
                candidates_of(linear, self._causes, self._changes.causes), blocks_of(linear)
            )
            self._tried, self._tried_for = tried_of(every), known
        return self._tried
