"""A diagnosis for studies: that of a user, without the next experiment."""

from collections.abc import Callable, Mapping

from bench.diagnose.diagnose import FALSE_ALARM_RATE, Diagnosis, diagnose
from bench.effects.effect import Effect
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot


def diagnose_with(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
    executor: Executor = SERIAL,
) -> Diagnosis:
    """Say what the nominal model gets wrong about a campaign; nothing else is handed in.

    Args:
        campaign: What the instruments saw.
        compiled: Its robot, nominal.
        catalogue: Effects to look for.
        rate: Declared false-alarm rate.
        progress: Called with what is done next.
        executor: Where to simulate.

    Raises:
        ConvergenceError: The nominal model finds no balance along the measured motion.
    """
    return diagnose(campaign, compiled, catalogue, rate, progress, proposes=False, executor=executor)
