"""Torques over the angle of the joints that nobody stated, a spring or a balancer: the robot as it was may have them.

Where a robot has no words for what carries its arm, figures and payload stand for it: of a stranger's palletising arm
with a spring a lower arm of 118 kg came out as 0.1 kg, and a tool of 14 kg as 0.2 kg a metre away. So all is fitted
beside a torque over the angle of every joint, several times as large as is plausible, as a diagnosis looks for causes
where nothing plausible explains a campaign. They act to first order while a fit goes on: a torque on a link is linear.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import LARGER
from bench.diagnose.linearise.generic import Block, blocks_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.candidate_model import with_shape
from bench.diagnose.name.discrepancy import effect_of, place_of
from bench.effects.effect import Acting


def free_torques(linear: LinearisedModel) -> tuple[Block, ...]:
    """Return a torque over the angle for each joint of which the campaign says anything."""
    found: dict[int, Block] = {}
    for block in blocks_of(linear):
        if (block.kind, block.depends_on) == ("link torque", "angle"):
            found.setdefault(block.drive, replace(block, prior=LARGER * block.prior))
    return tuple(found.values())


def beside(linear: LinearisedModel, torques: Sequence[Block]) -> LinearisedModel:
    """Return the campaign with torques over angles among what may be off, the last of it."""
    for torque in torques:
        linear = with_shape(linear, torque)
    return linear


def acting_in(linear: LinearisedModel, torques: Sequence[Block], fit: Fit) -> tuple[Acting, ...]:
    """Return the torques that a fit beside them found, as effects that a robot can have.

    Args:
        linear: The campaign without them.
        torques: Over the angle, one for each joint.
        fit: In the design with them.
    """
    values = fit.nuisances[len(linear.nuisances) :]
    edges = np.cumsum([0, *(len(torque.nodes) for torque in torques)])
    acting = []
    for torque, start in zip(torques, edges[:-1], strict=True):
        effect = effect_of(linear, torque)
        if effect is not None:  # a joint that moves over less than two nodes has no table
            own = torque.prior * values[start : start + len(torque.nodes)]
            names = [parameter.name for parameter in effect.parameters]
            acting.append(Acting(effect, place_of(linear, torque), dict(zip(names, own.tolist(), strict=True))))
    return tuple(acting)
