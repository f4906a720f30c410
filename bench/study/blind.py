"""A diagnosis for studies: that of a user, without the next experiment, with signatures simulated before."""

from collections.abc import Callable, Mapping

from bench.diagnose.diagnose import FALSE_ALARM_RATE, Diagnosis, diagnose
from bench.diagnose.diagnose import signatures_of as signatures_of  # of a session, for every campaign of it
from bench.diagnose.linearise.signatures import Signatures
from bench.effects.effect import Effect
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Campaign


def diagnose_with(
    campaign: Campaign,
    signatures: Signatures,
    catalogue: Mapping[str, Effect],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
    executor: Executor = SERIAL,
) -> Diagnosis:
    """Say what the nominal model gets wrong about a campaign; nothing else is handed in.

    Args:
        campaign: What the instruments saw.
        signatures: Of its session.
        catalogue: Effects to look for.
        rate: Declared false-alarm rate.
        progress: Called with what is done next.
        executor: Where to simulate.

    Raises:
        ConvergenceError: The nominal model finds no balance along the measured motion.
    """
    return diagnose(
        campaign, signatures.compiled, catalogue, rate, progress, signatures, proposes=False, executor=executor
    )
