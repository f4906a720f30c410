"""Many worlds at a time."""

from collections.abc import Sequence

from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import World
from bench.errors import BenchError
from bench.executor.contract import Executor, Progress, in_order
from bench.executor.serial import SERIAL
from bench.record.campaign import Array

# effort: worlds handed to a process at once: a tenth of a second, against which handing over counts little
PORTION = 20


def sound(found: Array | BenchError) -> Array:
    """Return what was simulated; raises the error that stands in its place."""
    if isinstance(found, BenchError):
        raise found
    return found


def simulate_all(replay: Replay, worlds: Sequence[World], executor: Executor = SERIAL) -> list[Array | BenchError]:
    """Return what instruments show in every world, each shape (T, c), or why a world could not be simulated.

    Args:
        replay: The campaign.
        worlds: Hypotheses.
        executor: Where to simulate.
    """

    def predict(world: World) -> Array | BenchError:
        try:
            return replay.predict(world)
        except BenchError as error:
            return error

    def predict_some(some: Sequence[World], _: Progress) -> list[Array | BenchError]:
        return [predict(world) for world in some]

    portions = [worlds[start : start + PORTION] for start in range(0, len(worlds), PORTION)]
    return [found for some in in_order(executor, predict_some, portions) for found in some]
