"""From the static runs of a campaign to the means that the stiffness methods work on."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.identify.readings import StaticReadings, Systematic
from bench.record.campaign import Array, Campaign, Run
from bench.record.channels import columns_of
from bench.robot.figures import Figures

AXES = ("x", "y", "z")
UNLOADED = 1e-9  # [N] and [Nm]; a load below is no load
HANGING = 1e-6  # a load hangs where its sideways part is below this share of it
UNIFORM = 1 / np.sqrt(12)  # standard deviation of rounding to 1


@dataclass(frozen=True)
class _State:
    """Means over the repeats of one state, their number, and from which side the pose was reached (0: unknown)."""

    q_motor: Array
    current: Array
    reflectors: Array
    wrench: Array
    load: Array
    repeats: int
    approach: int


def static_readings(campaign: Campaign, figures: Figures) -> StaticReadings:
    """Return the readings at rest of a campaign, one row per pose, approach direction and load step.

    A series is one visit: rows of one run with the same pose and approach. Where the motor angles were not logged the
    commands stand in; where no force sensor was logged, the known load. A load counts as hanging where the known load
    is vertical, or, if only the sensor was logged, where its sideways part is within four standard deviations of zero.

    Args:
        campaign: A validated campaign.
        figures: Of its robot; its instruments' figures are used where the campaign does not give its own noise.

    Raises:
        InputError: No run is static, or a visit was not read unloaded.
    """
    visits = [visit for run in campaign.of_kind("static") for visit in _visits(run, figures)]
    if not visits:
        raise InputError(
            "the campaign has no static run; stiffness needs readings at rest with and without load "
            "(of motion, --method dynamics tells friction, masses and payload)."
        )
    states = [state for visit in visits for state in visit]
    wrench = np.stack([state.wrench for state in states])
    load = np.stack([state.load for state in states])
    noise = _Noise(campaign, figures)
    known = np.all(np.isfinite(load[:, :3]), axis=1)
    push = np.where(known[:, None], load, wrench)
    size = np.linalg.norm(push[:, :3], axis=1)
    repeats = np.array([state.repeats for state in states])
    tolerance = np.where(known, HANGING * size, 4 * noise.force / np.sqrt(repeats))
    unloaded = np.where(known, np.linalg.norm(push, axis=1) < UNLOADED, size < 4 * noise.force)
    return StaticReadings(
        series=np.repeat(np.arange(len(visits)), [len(visit) for visit in visits]),
        is_reference=unloaded,
        q_motor=np.stack([state.q_motor for state in states]),
        current_torque=np.stack([state.current for state in states]) * noise.torque_constant,
        reflectors=np.stack([state.reflectors for state in states]),
        wrench=np.where(np.isfinite(wrench), wrench, load),
        is_vertical=np.linalg.norm(push[:, :2], axis=1) <= tolerance,
        n_repeats=repeats,
        sigma_current_torque=noise.torque_constant * noise.current,
        sigma_reflector=noise.reflector(states),
        sigma_wrench=np.repeat([noise.force, noise.moment], 3),
        reflector_names=figures.reflectors,
        load_point=figures.load_point,
        systematic=noise.systematic,
        sigma_q_motor=noise.q_motor,
        approach=np.array([state.approach for state in states]),
    )


def _visits(run: Run, figures: Figures) -> Iterator[list[_State]]:
    n, columns = len(figures.drives), run.columns
    drives = tuple(str(j) for j in range(1, n + 1))
    command, encoder = run.stack("q_cmd", "rad", drives), run.stack("q_motor", "rad", drives)
    q_motor = np.where(np.isfinite(encoder), encoder, command)
    current = run.stack("current", "a", drives)
    wrench = np.hstack([run.stack("force", "n", AXES), run.stack("moment", "nm", AXES)])
    only_force = np.isfinite(wrench[:, :3]).all(axis=1, keepdims=True) & ~np.isfinite(wrench[:, 3:])
    wrench[:, 3:] = np.where(only_force, 0.0, wrench[:, 3:])
    load = run.load_wrench()
    if not columns_of(columns, "load"):  # nothing is known of the load but what the sensor says, if there is one
        load[np.isfinite(wrench).all(axis=1)] = np.nan
    nests = range(1, len(figures.reflectors) + 1)
    reflectors = np.stack([run.stack(f"reflector_{k}", "m", AXES) for k in nests], axis=1)
    still = np.zeros(len(run))
    visit = np.stack([columns.get("pose", still), columns.get("approach", still)], axis=1)
    steps = columns.get("load_step", still)
    for pose in np.unique(visit, axis=0):
        here = np.all(visit == pose, axis=1)
        rows = [np.flatnonzero(here & (steps == step)) for step in np.unique(steps[here])]
        yield [
            _State(
                q_motor=q_motor[r].mean(axis=0),
                current=current[r].mean(axis=0),
                reflectors=reflectors[r].mean(axis=0),
                wrench=wrench[r].mean(axis=0),
                load=load[r].mean(axis=0),
                repeats=len(r),
                approach=int(pose[1]),
            )
            for r in rows
        ]


class _Noise:
    """Noise of one reading: the campaign's own figures where it gives them, else those of the robot's instruments."""

    def __init__(self, campaign: Campaign, figures: Figures) -> None:
        given, instruments = campaign.noise, figures.instruments
        current, force, tracker, encoder = (
            instruments.current,
            instruments.force,
            instruments.tracker,
            instruments.encoder,
        )
        rounding = current.resolution_a * UNIFORM if current else 0.0
        self.current = given.get("current", np.hypot(current.sigma_a if current else 0.0, rounding))
        self.force = given.get("force", force.sigma_n if force else 0.0)
        self.moment = given.get("moment", force.sigma_nm if force else 0.0)
        self.q_motor = given.get("q_motor", encoder.resolution_rad * UNIFORM if encoder else 0.0)
        self.torque_constant = np.array([drive.torque_constant_nm_per_a for drive in figures.drives])
        self._given_reflector, self._tracker = given.get("reflector"), tracker
        errors = np.array([drive.torque_constant_error for drive in figures.drives])
        self.systematic = Systematic(
            torque_gain=np.hypot(current.gain_sigma if current else 0.0, errors),
            force_gain=force.gain_sigma if force else 0.0,
            force_direction=force.direction_sigma_rad if force else 0.0,
            placement=tracker.placement_sigma_m if tracker else 0.0,
        )

    def reflector(self, states: list[_State]) -> float:
        """Return the standard deviation of one coordinate of one reading [m], at the mean distance from the tracker."""
        if self._given_reflector is not None:
            return self._given_reflector
        seen = np.stack([state.reflectors[0] for state in states])
        if self._tracker is None or not np.isfinite(seen).all(axis=1).any():
            return 0.0
        distance = np.linalg.norm(seen - np.array(self._tracker.position_m), axis=1)
        return float(self._tracker.sigma_per_distance * np.nanmean(distance))
