"""How high links bounce in the play of their gears: as high as what is left of the readings shows."""

from dataclasses import replace

import numpy as np

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.noise_covariance import gap_response
from bench.diagnose.linearise.rattling import ANYWHERE, rattles
from bench.record.campaign import Array

BOUNCES = np.geomspace(0.05, 1.0, 25)  # effort: that are tried; in steps of an eighth
FEW = 30  # declared: instants with a link that bounces, which tell how high to a seventh


def bounce_in(linear: LinearisedModel, residual: Array) -> float:
    """Return the root mean square of how far links are off their flanks, as `Play.bounce`; one for all gears.

    It is the value with the largest likelihood of what a model leaves of the instants in which links bounce, each for
    itself. Where there are too few of them, links are anywhere between the flanks.

    Args:
        linear: The campaign, with the play of the model.
        residual: Shape (T, c), that the model leaves.
    """
    compiled, play = linear.replay.compiled, linear.scatter.play
    likelihood, count = np.zeros(len(BOUNCES)), 0
    parts = zip(linear.weighed, linear.responses, linear.whitenings, linear.split(residual), strict=True)
    for segment, response, whitening, left in parts:
        if segment.is_static:
            continue
        off = [rattles(compiled, segment, response, replace(play, bounce=bounce)) for bounce in (*BOUNCES, play.bounce)]
        variances = np.stack(off) ** 2  # of links, in gaps
        rows = np.flatnonzero(np.any(variances[-2] > variances[0], axis=1))
        moved = (whitening.factors @ gap_response(compiled, segment, response, linear.quantities, play))[rows]
        white = np.zeros(left.size)
        white[whitening.rows] = whitening(left)
        pull = moved.transpose(0, 2, 1) @ white.reshape(*left.shape, 1)[rows]
        seen = moved.transpose(0, 2, 1) @ moved
        for k, more in enumerate((variances[:-1] - variances[-1])[:, rows, :, None]):
            widened = np.eye(len(play.gaps)) + more * seen
            likelihood[k] += 0.5 * float(np.sum(pull * np.linalg.solve(widened, more * pull)))
            likelihood[k] -= 0.5 * float(np.sum(np.linalg.slogdet(widened)[1]))
        count += int(np.count_nonzero(np.any(moved, axis=(1, 2))))
    return float(BOUNCES[np.argmax(likelihood)]) if count >= FEW else ANYWHERE
