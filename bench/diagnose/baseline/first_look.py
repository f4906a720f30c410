"""The first pass over a campaign, where it can be made: what a diagnosis of moving data begins with."""

from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from bench.errors import InputError
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass
from bench.record.campaign import Campaign, Run
from bench.robot.compiled import CompiledRobot
from bench.robot.nominal_dynamics import nominal_dynamics

MOST_SAMPLES = 250_000  # effort: of all runs together: ten runs of 50 s at 500 Hz, 11 s of processor time on six axes


@dataclass(frozen=True)
class FirstLook:
    """A first pass, or why there is none.

    Attributes:
        found: The first pass; None: it cannot be made.
        why: It cannot, in words; "" where nothing moves, so that nobody would expect one.
        share: Of each run that it was made of, from its beginning: less than 1 for very long recordings.
    """

    found: FirstPass | None
    why: str = ""
    share: float = 1.0


def first_look(campaign: Campaign, compiled: CompiledRobot) -> FirstLook:
    """Return the first pass over the motion runs of a campaign; it takes seconds.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
    """
    moving = tuple(campaign.of_kind("motion"))
    if not moving:
        return FirstLook(None)
    share = min(1.0, MOST_SAMPLES / sum(len(run) for run in moving))
    campaign = replace(campaign, runs=tuple(_beginning(run, share) for run in moving))
    try:
        with threadpool_limits(1, "blas"):  # the matrices are small: threads cost more than they give
            found = first_pass(campaign, nominal_dynamics(compiled))
    except InputError as error:
        return FirstLook(None, str(error))
    except np.linalg.LinAlgError as error:
        return FirstLook(None, f"the equations of its motion cannot be solved ({error})")
    if len(found.folds) < 2:
        return FirstLook(None, "all motion is one stretch, too short to hold a part of it out")
    return FirstLook(found, share=share)


def _beginning(run: Run, share: float) -> Run:
    rows = int(np.ceil(share * len(run)))
    return run if rows == len(run) else replace(run, columns={key: v[:rows] for key, v in run.columns.items()})
