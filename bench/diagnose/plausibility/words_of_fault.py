"""What is wrong with a channel, an angle or a load in a run, in words."""

import numpy as np

from bench.diagnose.plausibility.faults_of_run import ANGLES, LOADS, Fault
from bench.diagnose.plausibility.loads import TOO_SMALL
from bench.record.campaign import Array

LATEST = 0.1  # declared: of a run; a delay is told by rates of change, which mean nothing over more
HARDLY = "is hardly what all else makes of it"


def in_words(fault: Fault, values: Array, lasts: float) -> str:
    """Return what is wrong with a channel, an angle or a load in a run that lasts so long [s]."""
    if fault.subject[0] == LOADS:
        shown = float(1 + values[0])  # to first order: of what is several times off, the number is not
        if shown > TOO_SMALL:
            return "is several times smaller than the load that instruments show"
        if shown < 1 / TOO_SMALL:
            return "is far more than the load that instruments show"
        return f"is {1 / shown:.2g} times the load that instruments show"
    if fault.subject[0] == ANGLES:
        return f"is {values[0]:+.3g} {fault.unit} beside where the joint is by all else"
    if fault.how == "displaced":
        size = f"{values[0]:+.3g}" if len(values) == 1 else f"{np.linalg.norm(values):.3g}"
        return f"is {size} {fault.unit} beside what all else makes of it"
    if fault.how == "late" and abs(values[0]) > LATEST * lasts:
        return HARDLY
    if fault.how == "late":
        return f"is {abs(values[0]):.2g} s {'late' if values[0] > 0 else 'early'} by all else"
    times = f"{1 + values[0]:.3g}"
    return HARDLY if times == "1" else f"is {times} times what all else makes of it"
