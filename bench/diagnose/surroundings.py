"""What can be tried about an extended model: a robot that has friction may have more of it at low speed, and so on."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.diagnose.candidates import Cause, candidates_of, causes_of
from bench.diagnose.design import Design, raised, relinearised
from bench.diagnose.generic import blocks_of
from bench.diagnose.lack_of_fit import lack_of_fit
from bench.diagnose.refit import Fit, is_simulated, pseudo_residual
from bench.diagnose.replay import World, edits_in
from bench.diagnose.screening import Screening, screen
from bench.diagnose.signatures import Changes, Signatures
from bench.effects.effect import Conditions, Effect
from bench.errors import InputError
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot, compile_spec, read_spec

ENOUGH = 1.2  # times; standard errors that have to be raised by less are settled
ROUNDS = 3


@dataclass(frozen=True)
class Surroundings:
    """Looks for what an extended model makes possible.

    Attributes:
        compiled: The nominal robot.
        catalogue: Effects.
        measured: Quantities that the campaign has.
        rate: Declared false-alarm rate.
    """

    compiled: CompiledRobot
    catalogue: Mapping[str, Effect]
    measured: frozenset[str]
    rate: float

    def causes(self) -> tuple[Cause, ...]:
        """Return what can be tried on the nominal model."""
        return causes_of(self.catalogue.values(), self.compiled, self.measured)

    def weighed(self, design: Design, causes: Sequence[Cause], changes: Changes) -> tuple[Design, Screening]:
        """Return the nominal model with everything weighed against it.

        Args:
            design: The campaign.
            causes: What to try.
            changes: What they change.
        """
        return self._screened(design, lambda nominal: nominal.white, causes, changes)

    def about(self, design: Design, fit: Fit, known: Screening) -> tuple[Design, Screening] | None:
        """Return the linear picture about a fit, with everything that can be tried there.

        None if no effect finds a place there that it did not find before.

        Args:
            design: About the model before.
            fit: Of the extended model.
            known: What could be tried on the model before.
        """
        world = fit.world(design)
        edits = edits_in(World(acting=world.acting), Conditions.reference(self.compiled.n_joints))
        extended = compile_spec(read_spec(self.compiled.robot), self.compiled.robot, edits)
        taken = {cause.key for cause in fit.causes}
        causes = tuple(c for c in causes_of(self.catalogue.values(), extended, self.measured) if c.key not in taken)
        before = {entry.cause.key for entry in known.entries if entry.cause}
        if {cause.key for cause in causes} <= before | {cause.key for cause in self.causes()}:
            return None
        which = [i for i, nuisance in enumerate(design.nuisances) if is_simulated(nuisance)]
        nuisances = tuple(design.nuisances[i] for i in which)
        changes = Signatures(self.compiled, design.quantities, nuisances, causes, world).changes(design.segments)
        design = relinearised(design, which, changes.nuisances)
        return self._screened(design, lambda about: pseudo_residual(about, fit), causes, changes)

    def _screened(
        self, design: Design, white_of: Callable[[Design], Array], causes: Sequence[Cause], changes: Changes
    ) -> tuple[Design, Screening]:
        for _ in range(ROUNDS):
            candidates, blocks = candidates_of(design, causes, changes.causes), blocks_of(design)
            tried = [(c.columns, c.prior) for c in candidates]
            tried += [(block.columns, np.full(block.columns.shape[1], block.prior)) for block in blocks]
            if not tried:
                raise InputError("nothing of the catalogue would leave a trace in this campaign; see bench effects.")
            columns = np.concatenate([one for one, _ in tried], axis=1)
            prior = np.concatenate([one for _, one in tried])
            factors = lack_of_fit(design, white_of(design), columns, prior)
            if np.all((factors < ENOUGH) & (factors > 1 / ENOUGH)):
                break
            design = raised(design, factors)
        screening = screen(design, white_of(design), candidates, blocks, self.rate, np.random.default_rng(0))
        return design, screening
