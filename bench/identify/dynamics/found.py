"""What a first pass found, and what it predicts."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band
from bench.identify.dynamics.base_parameters import BaseParameters
from bench.identify.dynamics.bending import Bending, bent
from bench.identify.dynamics.consistency import Bodies
from bench.identify.dynamics.equations import BALANCER, DRIVE_COLUMNS, OPTIONAL, Equations, equations_of
from bench.identify.dynamics.falling_friction import FallingFriction
from bench.identify.dynamics.folds import Folds
from bench.identify.dynamics.found_arm import FoundArm
from bench.identify.dynamics.gear_load import loaded
from bench.identify.dynamics.held_out import HeldOut, Problems
from bench.identify.dynamics.leaning import leaning, leant
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.presliding import late
from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rows import DriveRows, rows_of
from bench.identify.dynamics.samples import MotionSamples, motion_samples
from bench.identify.dynamics.solve import Solution
from bench.identify.dynamics.widths import NONE
from bench.record.campaign import Array, Campaign
from bench.robot.nominal_dynamics import NominalDynamics


@dataclass(frozen=True)
class Torques:
    """What three models predict of the torque of each drive where it moves, after the stated filter.

    Attributes:
        joints: Names.
        measured, nominal, rival, first_pass: For each drive shape (R,) [Nm] or [N].
    """

    joints: tuple[str, ...]
    measured: tuple[Array, ...]
    nominal: tuple[Array, ...]
    rival: tuple[Array, ...]
    first_pass: tuple[Array, ...]

    def rms(self, model: str) -> Array:
        """Return the root mean square error of a model, shape (n,) [Nm]; nan for a drive that does not move.

        Args:
            model: "nominal", "rival" or "first_pass"; "measured" gives the torque's own.
        """
        found = []
        for measured, predicted in zip(self.measured, getattr(self, model), strict=True):
            error = measured if model == "measured" else measured - predicted
            found.append(float(np.sqrt(np.mean(error**2))) if len(error) else np.nan)
        return np.array(found)


@dataclass(frozen=True)
class FirstPass:
    """What moving data say of the dynamics by linear regression.

    Attributes:
        nominal: The robot as stated.
        arm: Its links.
        layout: Of the parameters.
        base: Its base parameters.
        band: The filter that model and data passed.
        rubbing: The arm whose torque friction grows with.
        falls: Friction that may fall during what was fitted.
        travel: Shape (n,) [rad] or [m], over which friction turns where it turns late; elsewhere it means nothing.
        bending: How its gears wind up; None where what was held out is not surely predicted better for it.
        leans: Whether its gravity leans, because what was held out is surely predicted better so.
        stretches: The thinned equations.
        problems: What was solved: prior, posterior, constraints, and plain least squares.
        parameters: Shape (p,), the posterior's most probable point among bodies that can exist: the result.
        rival_parameters: Shape (p,), its solution.
        folds: What was held out at a time.
        held_out: Errors on what was held out.
        top_speed: Shape (n,), of each joint in the campaign; slower than 8 % of it a joint does not count as moving.
    """

    nominal: NominalDynamics
    arm: Arm
    layout: Layout
    base: BaseParameters
    band: Band
    rubbing: FoundArm
    falls: FallingFriction
    travel: Array
    bending: Bending | None
    leans: bool
    stretches: tuple[Equations, ...]
    problems: Problems
    parameters: Array
    rival_parameters: Array
    folds: Folds
    held_out: HeldOut
    top_speed: Array

    @property
    def prior(self) -> Prior:
        """Of the parameters."""
        return self.problems.prior

    @property
    def solution(self) -> Solution:
        """The posterior, as if any number would do."""
        return self.problems.solution

    @property
    def bodies(self) -> Bodies:
        """What makes bodies that can exist of the parameters."""
        return self.problems.bodies

    @property
    def compliance(self) -> Array | None:
        """Shape (n,) [rad/Nm] or [m/N], of the gears, to first order; None where they are taken to be rigid."""
        if self.bending is None:
            return None
        return np.where(self.bending.winds, self.parameters[self.layout.softness], 0.0) / self.nominal.stiffness

    @property
    def gravity(self) -> Array:
        """Shape (3,) [m/s^2], as stated or as found."""
        return np.array(leant(self.arm.bodies, self.parameters[self.layout.lean]).gravity)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self.nominal.bodies.names

    @property
    def has(self) -> dict[str, tuple[int, ...]]:
        """Which drives have what of `OPTIONAL`, by name: what evidence and held-out errors want."""
        there = np.reshape([width != NONE for width in self.solution.widths.optional], (len(OPTIONAL), self.layout.n))
        return {name: tuple(np.flatnonzero(row).tolist()) for name, row in zip(OPTIONAL, there, strict=True)}

    def looks_for(self, what: str) -> bool:
        """Whether any drive could show something of `OPTIONAL`; a short recording shows no friction that falls."""
        columns = [DRIVE_COLUMNS.index(name) for name in (BALANCER if what == "balancer" else (what,))]
        return any(bool(np.any(part.drives[:, :, columns])) for part in self.stretches)

    def quantile(self, level: float = 0.9) -> float:
        """Return half the width of an interval in standard errors; Student's t with the independent readings left."""
        return float(stdtrit(self.solution.freedom, 0.5 + level / 2))

    def rows(self, stretches: Sequence[Equations], band: Band | None = None) -> tuple[DriveRows, ...]:
        """Return the equations of each drive, from stretches that passed `band`, by default that of the fit."""
        given = self.layout, band or self.band, self.arm, self.nominal
        return rows_of(stretches, *given)

    def equations(self, samples: MotionSamples, band: Band | None = None, *, is_fitted: bool = True) -> Equations:
        """Return the equations of a stretch that passes `band`, by default that of the fit.

        Args:
            samples: The stretch.
            band: The filter.
            is_fitted: Whether it is one of those that were fitted; another has friction of the middle of these.
        """
        band = band or self.band
        every = loaded([equations_of(samples, band, self.arm, self.nominal, self.top_speed)], self.rubbing, band)
        (found,) = late(every, self.travel, band)
        found = self.falls.added_to(found) if is_fitted else found
        found = bent(found, self.bending, band) if self.bending else found
        return leaning([found], self.arm, self.nominal)[0] if self.leans else found

    def predict(self, campaign: Campaign) -> Torques:
        """Return what nominal model, rival and first pass predict of another campaign; nothing is fitted.

        Raises:
            InputError: It has no motion with torques.
        """
        samples = motion_samples(campaign, self.nominal)
        found = [self.equations(part, is_fitted=False) for part in samples]
        return self.torques([part for part in found if len(part)])

    def torques(self, stretches: Sequence[Equations]) -> Torques:
        """Return measured and predicted torques of thinned equations."""
        rows, delay = self.rows(stretches), self.solution.delay
        return Torques(
            joints=self.joints,
            measured=tuple(one.response(delay) + one.known for one in rows),
            nominal=tuple(one.model(self.prior.mean) + one.known for one in rows),
            rival=tuple(one.model(self.rival_parameters) + one.known for one in rows),
            first_pass=tuple(one.model(self.parameters) + one.known for one in rows),
        )

    def held_out_rms(self, fold: int | None = None) -> Array:
        """Return the root mean square error on what was held out, shape (n,) [Nm]; of all folds, or of one."""
        return self.held_out.rms("first_pass", fold)
