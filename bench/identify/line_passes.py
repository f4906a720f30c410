"""From the motion runs of a campaign to passes along one line, side by side at equal places."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.errors import InputError
from bench.record.campaign import Campaign, Run
from bench.robot.bodies import Array
from bench.robot.figures import Figures

STATES = ("unloaded", "loaded")
WAYS = ("out", "back")
AXES = ("x", "y", "z")
FEWEST = 8  # rows of a run, for its noise to be seen


@dataclass(frozen=True)
class LinePass:
    """One pass at T places along the line, listed from its start to its end whichever way the robot went.

    Attributes:
        q_cmd: Shape (T, n) [rad].
        q_motor: Shape (T, n) [rad], or the command where no encoder was logged.
        current_torque: Shape (T, n) [Nm], xi_j I_j; nan where no current was logged.
        reflector: Shape (T, 3) [m], the reference point by the tracker.
        wrench: Shape (T, 6) [N, Nm], the load that is known to hang.
        is_out: Whether the robot went from the start to the end.
        sigma_current_torque: Shape (n,) [Nm], noise of one reading, from the readings themselves.
        sigma_reflector: Shape (3,) [m], likewise.
    """

    q_cmd: Array
    q_motor: Array
    current_torque: Array
    reflector: Array
    wrench: Array
    is_out: bool
    sigma_current_torque: Array
    sigma_reflector: Array

    def __len__(self) -> int:
        return len(self.q_cmd)


@dataclass(frozen=True)
class LinePasses:
    """Passes along one line at the same T places.

    Attributes:
        share: Shape (T,), place on the line, 0 at its start to 1 at its end.
        passes: (state, way) -> pass; state "unloaded" or "loaded", way "out" or "back".
        reference_point: Point of the arm with the reflector.
        load_point: Point of the arm on which the load hangs.
        current_gain: Shape (n,), prior standard deviation of the relative error of xi_j I_j.
    """

    share: Array
    passes: Mapping[tuple[str, str], LinePass]
    reference_point: str
    load_point: str
    current_gain: Array

    def of(self, state: str, way: str) -> LinePass:
        """Return a pass.

        Raises:
            InputError: The campaign has no such run.
        """
        if (state, way) not in self.passes:
            raise InputError(f"the campaign has no run {state}-{way}; run the line {way}, {state}, and add it.")
        return self.passes[state, way]


def line_passes(campaign: Campaign, figures: Figures, places: int | None = None) -> LinePasses:
    """Return the passes of a campaign: runs `unloaded-out`, `unloaded-back`, `loaded-out` and `loaded-back`, if there.

    The rows of a run lead from one end of the line to the other at constant speed, so the time within the run tells the
    place. Runs are interpolated to common places, which changes nothing where they were read at the same ones.

    Args:
        campaign: A validated campaign.
        figures: Of its robot.
        places: How many; None takes as many as the first run has rows.

    Raises:
        InputError: The robot has no reflector, no run has such a name, or one of them is too short or lacks commands or
            the reflector; all listed.
    """
    if not figures.reflectors:
        raise InputError("the robot has no reflector; a pass along the line is seen by a tracker.")
    named = {(state, way): run for run in campaign.runs for state, way in [_name(run)] if state}
    if not named:
        expected = ", ".join(f"{state}-{way}" for state in STATES for way in WAYS)
        raise InputError(f"the campaign has no pass along a line; runs of that experiment are named {expected}.")
    if problems := [problem for run in named.values() for problem in _problems(run)]:
        raise InputError(problems)
    share = np.linspace(0, 1, places or len(next(iter(named.values()))))
    constants = np.array([drive.torque_constant_nm_per_a for drive in figures.drives])
    gain_sigma = figures.instruments.current.gain_sigma if figures.instruments.current else 0.0
    return LinePasses(
        share=share,
        passes={key: _at(_pass(run, key[1] == "out", constants), share) for key, run in named.items()},
        reference_point=figures.reflectors[0],
        load_point=figures.load_point,
        current_gain=np.hypot([drive.torque_constant_error for drive in figures.drives], gain_sigma),
    )


def white_noise(values: Array) -> Array:
    """Return the standard deviation of white noise on smooth curves, shape (T, k), T > 2, as shape (k,).

    From second differences, which a smooth curve hardly has: their variance is six times that of the noise.
    """
    return np.asarray(np.sqrt(np.mean(np.diff(values, n=2, axis=0) ** 2, axis=0) / 6))


def _name(run: Run) -> tuple[str, str]:
    state, _, way = run.name.partition("-")
    return (state, way) if state in STATES and way in WAYS and run.kind == "motion" else ("", "")


def _problems(run: Run) -> Iterable[str]:
    needed = ["time_s", "q_cmd_1_rad", *(f"reflector_1_{axis}_m" for axis in AXES)]
    lacking = [column for column in needed if column not in run.columns]
    if lacking:
        yield f"run {run.name!r} lacks {', '.join(lacking)}; a pass along the line needs commands and the tracker."
    if len(run) < FEWEST:
        yield f"run {run.name!r} has {len(run)} rows; read it at {FEWEST} places or more."


def _pass(run: Run, is_out: bool, torque_constant: Array) -> LinePass:
    drives = tuple(str(j) for j in range(1, len(torque_constant) + 1))
    command, encoder = run.stack("q_cmd", "rad", drives), run.stack("q_motor", "rad", drives)
    torque = torque_constant * run.stack("current", "a", drives)
    reflector = run.stack("reflector", "m", tuple(f"1_{axis}" for axis in AXES))
    return LinePass(
        q_cmd=command,
        q_motor=np.where(np.isfinite(encoder), encoder, command),
        current_torque=torque,
        reflector=reflector,
        wrench=run.load_wrench(),
        is_out=is_out,
        sigma_current_torque=white_noise(torque),
        sigma_reflector=white_noise(reflector),
    )


def _at(line_pass: LinePass, share: Array) -> LinePass:
    """Return a pass read at evenly spaced places, interpolated to other places and listed from start to end."""
    here = np.linspace(0, 1, len(line_pass))

    def moved(values: Array) -> Array:
        ordered = values if line_pass.is_out else values[::-1]
        return np.stack([np.interp(share, here, column) for column in ordered.T], axis=1)

    return replace(
        line_pass,
        q_cmd=moved(line_pass.q_cmd),
        q_motor=moved(line_pass.q_motor),
        current_torque=moved(line_pass.current_torque),
        reflector=moved(line_pass.reflector),
        wrench=moved(line_pass.wrench),
    )
