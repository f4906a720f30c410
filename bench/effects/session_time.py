"""What changes in the robot while a session goes on: gas that leaks, gas that is gone all at once, a joint that slips.

A constant cause with the same part in it stands against each of these: where it fits as well, nothing changed.
"""

from collections.abc import Hashable

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Parameter, Place, Values
from bench.effects.gas import OfGas, amount_scaled
from bench.effects.places import drive_of, drives
from bench.effects.recorded import Recorded, RecordedRun
from bench.effects.recording_places import OfCampaign
from bench.record.units import HOUR
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.robot.patching.numbers import UNSET_LENGTH


class GasLeak(OfGas):
    """The cylinder leaks while it is measured."""

    name = "gas_leak"
    level = "run"
    title = "gas that leaks during the session"
    physics = (
        "Gas escapes at a constant rate r: at the time t since the start of the campaign F is (1 - r t) of itself."
    )
    source = "range: 1 to 30 % in an hour, a leak that can be heard; assumed"
    advice = "read the gauge in the same pose at the start and at the end of the session"
    parameters = (Parameter("rate", "1/h", 0.0, 0.01, 0.3, "r, share of the charge", least=0.0),)

    def phase(self, place: Place, conditions: Conditions) -> Hashable:
        """Return the time: gas is lost all the while."""
        return conditions.time_s

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        return amount_scaled(max(1 - values["rate"] * conditions.time_s / HOUR, 0.0))


class _SetsIn(OfCampaign):
    """It is not there before some run, and there from then on."""

    level = "run"

    def phase(self, place: Place, conditions: Conditions) -> Hashable:
        """Return whether it has set in."""
        return conditions.time_s >= place.since_s


class GasStep(_SetsIn):
    """Gas was let out or filled in between two runs."""

    name = "gas_step"
    family = "gas and cylinder"
    title = "gas lost or filled in"
    physics = "Between two runs gas was let out, or filled in: from then on F is (1 - x) of itself at every length."
    source = "range: 1 to 30 % of the charge, as of gas_loss; assumed"
    advice = "ask what was done to the cylinder before this run"
    parameters = (Parameter("lost", "", 0.0, 0.01, 0.3, "x, share of the charge that is gone", signed=True, most=1.0),)

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return the robot once for each run after a break, if it has a cylinder at work."""
        if not compiled.counterbalance:
            return ()
        return tuple(Place("robot", since=run.name, since_s=run.start_s) for run in recorded.after_breaks)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        return amount_scaled(1 - values["lost"]) if self.phase(place, conditions) else None


class JointSlip(_SetsIn):
    """A bolted joint slips, or an encoder loses its zero, between two runs."""

    name = "joint_slip"
    family = "geometry and mass"
    title = "zero of a joint that jumped"
    physics = (
        "A bolted flange slips, or an encoder loses its zero: from then on the link stands x further back than the "
        "encoder says, k (q - theta - x) on the elastic element."
    )
    source = "range: 0.005 to 0.3 deg, as of joint_zero and beyond; assumed"
    advice = "look at bolts and encoder of this joint, and master it anew"
    parameters = (Parameter("slip", "rad", 0.0, 8.7e-5, 5e-3, "x, encoder less link", signed=True),)

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return each drive once for each run after a break in which the links are seen."""
        return tuple(
            Place("joint", drive.index, drive.name, run.name, run.start_s)
            for drive in drives(compiled)
            for run in recorded.setting_in(_sees_links)
        )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        slip = values["slip"]

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            element = spec.tendon(drive_of(robot, place).element)
            lengths = np.asarray(element.springlength)
            element.springlength = np.where(lengths == UNSET_LENGTH, 0.0, lengths) + slip  # where q = theta it is 0

        return change if slip and self.phase(place, conditions) else None


def _sees_links(run: RecordedRun) -> bool:
    """Whether reflectors or secondary encoders were read: currents hardly tell where a link stands."""
    return any(name.startswith(("reflector_", "q_link_")) for name in run.columns)
