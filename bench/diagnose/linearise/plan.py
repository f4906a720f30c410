"""What is simulated to learn what nuisances and effects change in the readings: one at a time, about one world."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.effect import Acting
from bench.robot.compiled import CompiledRobot


@dataclass(frozen=True, eq=False)
class Plan:
    """What is changed, one at a time.

    Attributes:
        compiled: The robot.
        quantities: What is compared.
        nuisances: By one standard deviation each.
        acting: What acts as well, one at a time.
        is_strict: Whether a nuisance that leaves no balance is an error.
        simulates_torques: Whether effects that act as torques are simulated, too; else they are taken to first order.
        beside: Index of `acting` -> what acts both with and without it.
        around: World that is changed.
    """

    compiled: CompiledRobot
    quantities: tuple[Quantity, ...]
    nuisances: tuple[Nuisance, ...]
    acting: tuple[Acting, ...]
    is_strict: bool = True
    simulates_torques: bool = False
    beside: Mapping[int, Acting] = field(default_factory=dict)
    around: World = NOMINAL

    def __len__(self) -> int:
        return len(self.nuisances) + len(self.acting)
