"""How far apart loose links lie from run to run, while their joints stand and others move.

Within the gap of its gear a link that nothing pushes may lie anywhere, so a play scatters it from one run to the next.
Where runs show that it does not (an arm that is brought to where it begins in the same way each time, or one that never
left), a play that charges for such scatter loses to whatever else bends the gear without it: a softening. How much
there may be is read from the runs themselves, without any play, and again about each better model.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.linalg import block_diag

from bench.diagnose.linearise.noise_covariance import Whitening, begins_of, measured_in, of_links
from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.play import is_loose
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

# effort: deviations that are tried, in those that the surest place tells from none
SIZES = np.append(0.0, np.geomspace(1e-3, 1e3, 121))
# exact: by which the logarithm of a likelihood falls from its largest value to that at the 95th percentile: half of the
# square of 1.645 (Wilks)
FALLS = 1.353
TINY = 1e-12  # rounding: of what a place changes; less is nothing


def most_placed(
    compiled: CompiledRobot,
    segments: Sequence[Segment],
    responses: Sequence[TorqueResponse],
    quantities: tuple[Quantity, ...],
    whitenings: Sequence[Whitening],
    jacobian: Array,
    white: Array,
) -> Array:
    """Return the largest deviation of the places of loose links that motions allow, shape (n,) [rad] or [m].

    It is where the likelihood, beyond its largest value, has fallen to that of the 95th percentile; inf where no motion
    tells, or where gears have play already. What figures and instruments may explain of a place tells nothing.

    Args:
        compiled: The robot.
        segments: Of the campaign.
        responses: Of their readings to torques.
        quantities: What is compared.
        whitenings: Of each segment, of the robot as it is.
        jacobian: Shape (m, p), of nuisances with a prior of one, whitened.
        white: Shape (m,), whitened, what the robot leaves of the readings.
    """
    told: dict[int, list[tuple[Array, Array, Array]]] = {}  # by joint: places by themselves, and with nuisances
    end = 0
    for segment, response, whitening in zip(segments, responses, whitenings, strict=True):
        start, end = end, end + len(whitening.modes)
        for j, columns in _places(compiled, segment, response, quantities):
            changes = whitening(columns)
            parts = changes.T @ changes, changes.T @ white[start:end], jacobian[start:end].T @ changes
            told.setdefault(j, []).append(parts)
    found = np.full(compiled.n_joints, np.inf)
    if not told:
        return found
    normal, slope = jacobian.T @ jacobian + np.eye(jacobian.shape[1]), jacobian.T @ white
    for j, every in told.items():
        plain, left, shared = zip(*every, strict=True)
        together = np.concatenate(shared, axis=1)
        taken = np.linalg.solve(normal, together)
        weight, axes = np.linalg.eigh(block_diag(*plain) - together.T @ taken)
        found[j] = _most(weight, (axes.T @ (np.concatenate(left) - taken.T @ slope)) ** 2)
    return found


def _places(
    compiled: CompiledRobot, segment: Segment, response: TorqueResponse, quantities: tuple[Quantity, ...]
) -> Iterator[tuple[int, Array]]:
    """Yield joints, and what each place of its link changes in a motion, shape (T, c, k), per rad or m.

    A loose link has a place for as long as nothing pushes it.
    """
    stands = segment.standing & (compiled.play == 0) & (not segment.is_static)
    if not np.any(stands):
        return
    loose = is_loose(compiled, response.link_load) & stands
    moved = of_links(compiled, response, measured_in(segment, quantities), quantities)
    for j in np.flatnonzero(loose.any(axis=0)):
        begins = begins_of(loose[:, j])
        yield int(j), moved[:, :, [j]] * (begins[:, None] == np.unique(begins[begins >= 0]))[:, None]


def _most(weight: Array, square: Array) -> float:
    """Return the largest deviation that is allowed; weights and squares of what changes of a place explain, (k,)."""
    tells = weight > TINY * max(float(np.max(weight)), TINY)
    weight, square = weight[tells], square[tells]
    if not len(weight):
        return np.inf
    variance = SIZES[:, None] ** 2 / np.max(weight)
    likelihood = -0.5 * np.sum(np.log1p(variance * weight) - square * variance / (1 + variance * weight), axis=1)
    best = int(np.argmax(likelihood))
    beyond = np.flatnonzero(likelihood[best:] < likelihood[best] - FALLS)
    return float(SIZES[best + beyond[0]] / np.sqrt(np.max(weight))) if len(beyond) else np.inf
