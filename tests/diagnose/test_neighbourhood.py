"""What can be tried about an extended model, and what it takes for that."""

from bench.diagnose.linearise.candidates import causes_of
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.replay.world import World, edits_in
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting, Conditions
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot

SIZES = {"coulomb_friction": {"level": 100.0}, "viscous_friction": {"coefficient": 300.0}, "link_mass": {"change": 0.1}}
MORE = ("coulomb_level", "viscous_level", "direction_friction", "direction_viscous")


def test_more_of_a_friction_needs_the_friction_that_was_found() -> None:
    """Without it there is none to have more of: such a name stood in the place of viscous friction in each search."""
    kr300 = compile_robot(load_robot("kr300"))
    effects = {name: effect for name, effect in catalogue().items() if name in (*SIZES, *MORE)}
    measured = frozenset({"tau_motor"})
    here = [cause for cause in causes_of(effects.values(), kr300, measured) if cause.effect.name in SIZES]
    found = [next(cause for cause in here if cause.effect.name == name) for name in SIZES]
    world = World(acting=tuple(Acting(one.effect, one.place, SIZES[one.effect.name]) for one in found))
    around = Neighbourhood(kr300, effects, measured, 0.01)
    coulomb, viscous, _ = (cause.key for cause in found)

    def robot_of(world: World) -> CompiledRobot:
        return compile_robot(kr300.robot, edits_in(world, Conditions.reference(kr300.n_joints)))

    assert around.needs(found, world, robot_of) == {
        ("coulomb_level", "joint 1"): {coulomb},
        ("direction_friction", "joint 1"): {coulomb},
        ("viscous_level", "joint 1"): {viscous},
        ("direction_viscous", "joint 1"): {coulomb, viscous},
    }
