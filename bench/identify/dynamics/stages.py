"""What a first pass adds to its first fit, one after the other, where what was held out is surely predicted better.

Setting     what all fits share: parameters, prior, filter, folds
|
begun()         links with rigid gears, friction by what they pass on and by time
turning_late()  friction that turns late (`presliding.py`)
winding()       gears that wind up (`bending.py`)
leaning()       a base out of level (`leaning.py`), about which all else is found anew
|
Fit
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bench.identify.arm import Arm
from bench.identify.dynamics import chosen
from bench.identify.dynamics import leaning as base_level
from bench.identify.dynamics.band import Band
from bench.identify.dynamics.bending import Bending, bending_of, bent
from bench.identify.dynamics.consistency import Bodies, bodies_of, nearest
from bench.identify.dynamics.equations import Equations
from bench.identify.dynamics.falling_friction import FallingFriction, falling_friction
from bench.identify.dynamics.folds import Folds
from bench.identify.dynamics.found_arm import FoundArm, found_arm
from bench.identify.dynamics.gear_load import loaded
from bench.identify.dynamics.held_out import Missed
from bench.identify.dynamics.normal import Weighed, normal_of
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.presliding import late, likeliest_travel
from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rows import DriveRows, rows_of
from bench.identify.dynamics.solve import Solution, solve
from bench.identify.dynamics.widths import Widths
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics


@dataclass(frozen=True)
class Fit:
    """A posterior, and the equations that it is of.

    Attributes:
        solution: The posterior.
        beside: What it misses of what was held out.
        stretches: The equations, with all that the fit has.
        at_once: The same with friction that turns at once, rigid gears and a base as stated.
        rubbing: The arm by whose torques friction grows.
        falls: Friction that may fall in the course of a recording.
        travel: Shape (n,) [rad] or [m], over which friction turns where it does.
        turns_late: Whether friction may turn late.
        bending: Gears that wind up; None: they are rigid.
        leans: Whether the base is out of level.
    """

    solution: Solution
    beside: Missed
    stretches: tuple[Equations, ...]
    at_once: tuple[Equations, ...]
    rubbing: FoundArm
    falls: FallingFriction
    travel: Array
    turns_late: bool = False
    bending: Bending | None = None
    leans: bool = False


@dataclass(frozen=True)
class Setting:
    """What all fits of a campaign share.

    Attributes:
        layout: Of the parameters.
        band: The filter.
        arm: Links as stated.
        nominal: The robot.
        prior: Of the parameters.
        folds: What is held out at a time.
        find_delay: Whether torques may be later than angles.
    """

    layout: Layout
    band: Band
    arm: Arm
    nominal: NominalDynamics
    prior: Prior
    folds: Folds
    find_delay: bool

    def rows(self, stretches: Sequence[Equations]) -> tuple[DriveRows, ...]:
        """Return the equations of each drive."""
        return rows_of(stretches, self.layout, self.band, self.arm, self.nominal)

    def bodies(self, solution: Solution) -> Bodies:
        """Return the bodies that parameters make."""
        payload = self.nominal.payload, self.nominal.payload_side
        return bodies_of(self.layout, self.arm.joint_names, self.prior.mean, solution.prior_sigma, *payload)

    def existing(self, solution: Solution) -> Array:
        """Return the most probable parameters of bodies that can exist, shape (p,)."""
        factor, gram = self.prior.factor(solution.widths), solution.normal.gram
        return nearest(self.bodies(solution), solution.parameters, self.prior.mean, factor, gram)

    def begun(self, stretches: tuple[Equations, ...]) -> Fit:
        """Return the first fit: friction grows with what links pass on as a fit without that has them."""
        first = self._solved(stretches, self.find_delay)
        rubbing, falls = self._arm(first), falling_friction(stretches, self.layout, first.parameters)
        by_load = tuple(map(falls.added_to, loaded(stretches, rubbing, self.band)))
        solution, beside = self._chosen(by_load, self.find_delay)
        return Fit(solution, beside, by_load, by_load, rubbing, falls, np.zeros(self.layout.n))

    def turning_late(self, fit: Fit) -> Fit:
        """Return a fit in which friction turns late, or that with the travels over which it would."""
        late_fit = self._travelling(fit, fit.solution.delay != 0)
        late_rows = _with_rows(fit.solution, self.rows(late_fit.stretches), self.layout.size)
        asked = chosen.turning_late(late_rows, self.prior)
        if asked == fit.solution.widths:
            return late_fit
        turning = self._again(replace(late_fit, turns_late=True))
        if not turning.beside.surely_less_than(fit.beside):
            return late_fit
        is_late = turning.solution.delay != 0
        if is_late == (fit.solution.delay != 0):
            return turning
        # late friction may have been a delay, about which its travels were found
        return self._again(replace(self._travelling(fit, is_late), turns_late=True), find_delay=is_late)

    def winding(self, fit: Fit, begin: Widths | None = None) -> Fit:
        """Return a fit whose gears wind up with their torque, or the same.

        Args:
            fit: With rigid gears.
            begin: Widths to begin with, by default the usual.
        """
        bending, stretches = self._forwards(bending_of(self._arm(fit.solution)), fit.stretches)
        if not bending.winds.any():
            return fit
        wound = self._again(replace(fit, stretches=stretches, bending=bending), begin)
        return wound if wound.beside.surely_less_than(fit.beside) else fit

    def leaning(self, fit: Fit) -> Fit:
        """Return a fit whose base is out of level, or the same."""
        tilted = self._tilted(fit.stretches)
        likely = self._solved(tilted, fit.solution.delay != 0, fit.solution.widths)
        if not base_level.seems_to_lean(likely, self.layout):
            return fit
        leant = self._again(replace(fit, stretches=tilted, leans=True), fit.solution.widths)
        if not leant.beside.surely_less_than(fit.beside):
            return fit
        # that was noise so far, about which all else was found: what slewing gears pass on, travels, winding
        rubbing, begin = self._arm(leant.solution), leant.solution.widths
        stretches = self._tilted(loaded(fit.at_once, rubbing, self.band))
        anew = replace(leant, at_once=stretches, rubbing=rubbing, bending=None)
        anew = self._travelling(anew, leant.solution.delay != 0) if fit.turns_late else self._late(anew, fit.travel)
        return self.winding(self._again(anew, begin), begin)

    def _arm(self, solution: Solution) -> FoundArm:
        return found_arm(self.nominal, self.arm, self.layout, self.existing(solution))

    def _solved(self, stretches: Sequence[Equations], find_delay: bool, begin: Widths | None = None) -> Solution:
        given = self.rows(stretches), self.prior, self.band.cutoff_hz, np.ones(self.layout.n)
        return solve(*given, find_delay, begin=begin)

    def _chosen(
        self,
        stretches: Sequence[Equations],
        find_delay: bool,
        turns_late: bool = False,
        begin: Widths | None = None,
    ) -> tuple[Solution, Missed]:
        given = self.rows(stretches), self.prior, self.band, self.folds
        return chosen.with_its_delay(*given, find_delay=find_delay, turns_late=turns_late, begin=begin)

    def _again(self, fit: Fit, begin: Widths | None = None, *, find_delay: bool | None = None) -> Fit:
        """Return a fit of its equations, anew."""
        may_be_late = self.find_delay if find_delay is None else find_delay
        solution, beside = self._chosen(fit.stretches, may_be_late, fit.turns_late, begin)
        return replace(fit, solution=solution, beside=beside)

    def _travelling(self, fit: Fit, find_delay: bool) -> Fit:
        """Return a fit with the equations of friction that turns over the likeliest travels; it is not fitted anew."""
        about_it = partial(self._solved, find_delay=find_delay, begin=fit.solution.widths)
        travel = likeliest_travel(fit.at_once, self.layout, self.prior, self.band, fit.solution, about_it)
        return self._late(fit, travel)

    def _late(self, fit: Fit, travel: Array) -> Fit:
        return replace(fit, stretches=late(fit.at_once, travel, self.band), travel=travel)

    def _tilted(self, stretches: tuple[Equations, ...]) -> tuple[Equations, ...]:
        return base_level.leaning(stretches, self.arm, self.nominal)

    def _forwards(self, bending: Bending, stretches: Sequence[Equations]) -> tuple[Bending, tuple[Equations, ...]]:
        """Return the gears that wind up with their torque, for none does against it, and the equations with that.

        Args:
            bending: How all gears would wind up.
            stretches: Equations of an arm with rigid gears.
        """
        found = tuple(bent(part, bending, self.band) for part in stretches)
        while True:
            softness = self._solved(found, self.find_delay).parameters[self.layout.softness]
            backwards = bending.winds & (softness < 0)
            if not np.any(backwards):
                return bending, found
            bending = replace(bending, winds=bending.winds & ~backwards)
            found = tuple(replace(part, winding=part.winding * bending.winds) for part in found)


def _with_rows(solution: Solution, rows: Sequence[DriveRows], size: int) -> Solution:
    """Return a solution with the normal equations of other rows, about the same parameters and weighted alike."""
    about = solution.parameters
    drives = tuple(Weighed.about(new, about, old.weight) for new, old in zip(rows, solution.drives, strict=True))
    return replace(solution, drives=drives, normal=normal_of(drives, solution.delay, size))
