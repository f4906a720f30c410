"""A campaign as the nominal robot repeats it, for all who look at it: each part is made when somebody first asks."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

from bench.diagnose.plausibility.drive_looks import DriveLook, drive_looks, resting_torque
from bench.diagnose.plausibility.drive_picture import DrivePicture, drive_picture
from bench.diagnose.plausibility.some_channels import with_channels
from bench.diagnose.replay.quantities import Quantity, quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment, segments_of
from bench.record.campaign import Array, Campaign
from bench.record.carried import with_payloads
from bench.robot.compiled import CompiledRobot
from bench.robot.patched import Structure
from bench.simulate.bare import bare_spec

BINS = 400  # effort: of one run at most; enough to tell a sign


@dataclass(frozen=True, eq=False)
class Repeated:
    """A campaign and the nominal robot that repeats it.

    Attributes:
        campaign: A checked campaign, with known payloads carried.
        compiled: Its robot, nominal.
    """

    campaign: Campaign
    compiled: CompiledRobot

    @classmethod
    def of(cls, campaign: Campaign, compiled: CompiledRobot) -> Self:
        """Return a checked campaign as its robot, nominal, repeats it."""
        return cls(with_payloads(campaign), compiled)

    @cached_property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the campaign has of what the model predicts."""
        return quantities_of(self.campaign.runs, self.compiled)

    @cached_property
    def drives(self) -> tuple[Quantity, ...]:
        """Those of drives."""
        return tuple(quantity for quantity in self.quantities if quantity.is_drive)

    @cached_property
    def others(self) -> tuple[Quantity, ...]:
        """Those of all other instruments."""
        return tuple(quantity for quantity in self.quantities if not quantity.is_drive)

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """With readings of all quantities."""
        return segments_of(self.campaign, self.compiled, self.quantities, BINS)

    @cached_property
    def paid(self) -> tuple[Segment, ...]:
        """Segments in which drives were read, with their readings."""
        return with_channels(self.segments, self.quantities, self.drives)

    @cached_property
    def seen(self) -> tuple[Segment, ...]:
        """Segments in which anything else was read, with its readings."""
        return with_channels(self.segments, self.quantities, self.others)

    @cached_property
    def by_drives(self) -> Replay:
        """Of `paid`, of which there have to be some; raises a ConvergenceError where the model cannot follow."""
        return self.replay(self.paid, self.drives)

    @cached_property
    def by_others(self) -> Replay:
        """Of `seen`, likewise."""
        return self.replay(self.seen, self.others)

    @cached_property
    def picture(self) -> DrivePicture:
        """What the drives did."""
        return drive_picture(self.by_drives)

    @cached_property
    def at_rest(self) -> Array:
        """Shape (T, n) [Nm], the nominal model's torque of `paid` without what comes with motion."""
        return resting_torque(self.by_drives)

    @cached_property
    def looks(self) -> tuple[DriveLook, ...]:
        """A first look at each drive that moves enough."""
        return drive_looks(self.picture, self.at_rest)

    def replay(self, segments: tuple[Segment, ...], quantities: tuple[Quantity, ...]) -> Replay:
        """Return a replay of any segments by the same robot."""
        return Replay(self.compiled, segments, quantities, structure=self._structure)

    @cached_property
    def _structure(self) -> Structure:
        return Structure(self.compiled.robot, bare_spec(self.compiled.robot))
