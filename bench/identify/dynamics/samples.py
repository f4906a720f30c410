"""Moving data of a campaign as arrays: one `MotionSamples` for each motion run."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.record.campaign import Array, Campaign, Run
from bench.record.carried import load_with_weight, with_payloads
from bench.record.rules.clock import JITTER
from bench.robot.nominal_dynamics import NominalDynamics

FEWEST = 60  # declared: samples of a stretch without gaps; below that, filters see little but its ends
# effort: samples of a stretch; its equations of six axes take 72 MB, and as much again while they are filtered
LONGEST = 25_000


@dataclass(frozen=True)
class MotionSamples:
    """A stretch of one motion run without gaps; T samples of n drives.

    Attributes:
        run: Name of the run.
        recording: Name of its recording.
        rate: Samples per second [Hz].
        time: Shape (T,) [s].
        position: Shape (T, n) [rad] or [m]; motor encoders, and the command of drives without one.
        command: Shape (T, n); nan where there is none.
        torque: Shape (T, n) [Nm] or [N], of the motor at the joint; nan for drives without a reading.
        wrench: Shape (T, 6) [N, Nm], known load on the load point, world axes.
        load_mass: Shape (T,) [kg], mass that moves with the load point and whose weight is in `wrench`.
        start: From the start of its recording to that of the run [s].
    """

    run: str
    recording: str
    rate: float
    time: Array
    position: Array
    command: Array
    torque: Array
    wrench: Array
    load_mass: Array
    start: float = 0.0

    def __len__(self) -> int:
        return len(self.time)


def motion_samples(campaign: Campaign, nominal: NominalDynamics) -> tuple[MotionSamples, ...]:
    """Return the moving data of a campaign; a run with lost samples is cut where they are lost, a long one anywhere.

    A payload that the lab knows besides is what runs carry that state none. Where a drive reports torque that is taken,
    else its current times the torque constant.

    Raises:
        InputError: No motion run has torques or currents, evenly sampled.
    """
    moving = with_payloads(campaign).of_kind("motion")
    found = [stretch for run in moving for stretch in _stretches(run, nominal)]
    if not found:
        raise InputError(
            "method 'dynamics' needs a motion run with motor torques (tau_motor_i_nm) or currents (current_i_a), "
            f"sampled evenly for at least {FEWEST} samples; this campaign has none."
        )
    return tuple(found)


def _stretches(run: Run, nominal: NominalDynamics) -> Iterator[MotionSamples]:
    slide = ~nominal.bodies.is_hinge
    encoder, command = (_by_drive(run, quantity, ("rad", "m"), slide) for quantity in ("q_motor", "q_cmd"))
    torque = _by_drive(run, "tau_motor", ("nm", "n"), slide)
    current = _by_drive(run, "current", ("a", "a"), slide) * nominal.torque_constant
    torque = np.where(np.isfinite(torque), torque, current)
    if len(run) < FEWEST or not np.isfinite(torque).any():
        return
    time = run.columns["time_s"]
    wrench, mass = load_with_weight(run), run.columns.get("load_mass_kg", np.zeros(len(run)))
    step = np.diff(time)
    median = float(np.median(step))
    cuts = np.flatnonzero(np.abs(step - median) > JITTER * median) + 1
    whole = (rows for rows in np.split(np.arange(len(time)), cuts) if len(rows) >= FEWEST)
    for rows in (part for piece in whole for part in np.array_split(piece, -(-len(piece) // LONGEST))):
        yield MotionSamples(
            run=run.name,
            recording=run.recording,
            rate=float((len(rows) - 1) / (time[rows[-1]] - time[rows[0]])),
            time=time[rows],
            position=np.where(np.isfinite(encoder), encoder, command)[rows],
            command=command[rows],
            torque=torque[rows],
            wrench=wrench[rows],
            load_mass=mass[rows],
            start=run.start_s,
        )


def _by_drive(run: Run, quantity: str, units: tuple[str, str], slide: np.ndarray) -> Array:
    """Return a quantity of each drive, shape (T, n); `units` of a hinge and of a slide; nan where it was not logged."""
    keys = tuple(str(i + 1) for i in range(len(slide)))
    hinge, sliding = (run.stack(quantity, unit, keys) for unit in units)
    return np.where(slide, sliding, hinge)
