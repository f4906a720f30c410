"""How clearly a change shows to one who knows it: the bound of what any comparison of two recordings can find."""

import numpy as np

from bench.compare.background import Background
from bench.compare.shared import undo_segments
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.effect import Acting


def visibility(background: Background, acting: Acting) -> float:
    """Return by how many standard deviations a change stands out to one who knows its effect, place, shape and size.

    It is simulated, acts in every recording but the first, and all that stayed or is set up anew is as unknown as to
    the comparison: what is left out is only which of all changes it is, and how large. Below sqrt(2 b) it is on
    average no evidence of b, whoever looks.

    Args:
        background: All recordings, with settled noise.
        acting: The change.

    Raises:
        ConvergenceError: The model with the change finds no balance.
    """
    joint = background.joint
    replay = joint.linear.replay
    change = replay.predict(World(acting=(acting,))) - replay.predict(NOMINAL)
    white = joint.linear.whiten(change[:, :, None])
    undo_segments(joint.linear, white)
    seen = background.whitening.of_instants(white * (joint.of_row > 0)[:, None])
    return float(np.sqrt(background.nuisances.products(background.white, seen).diagonal[0]))
