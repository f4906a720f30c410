"""A joint that stops briskly throws its link forward, and friction may arrive turned round."""

from dataclasses import replace

import numpy as np

from bench.diagnose.linearise.held_friction import arrived_otherwise
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL
from bench.simulate.prescribed import Prescribed
from tests.diagnose.noise_free import linearised
from tests.diagnose.small_models import chi_square_left
from tests.diagnose.sweeps import LOADS, made, nominal


def test_a_link_that_arrives_the_other_way_is_what_an_approach_from_there_leaves() -> None:
    """Held against the replay: the same rests, approached from the other side; loads wipe out where friction was."""
    linear, robot = linearised(made(LOADS, seed=5)), nominal()
    levels, most = robot.link_coulomb, 0.0
    for segment in linear.segments:
        motion = segment.motion
        mirrored = motion.q.copy()
        mirrored[0] = 2 * motion.q[1] - motion.q[0]
        here, *_ = Prescribed(robot).follow(motion)
        there, *_ = Prescribed(robot).follow(replace(motion, q=mirrored))
        change = (there.link_friction - here.link_friction) / levels
        found = arrived_otherwise(robot, here) / levels
        np.testing.assert_allclose(np.abs(found[0]), 2.0, rtol=0.02)
        np.testing.assert_allclose(found, change, atol=0.02)
        assert np.all(np.abs(found[-1][1:3]) < 0.05)  # joints 2 and 3, which the loads moved
        most = max(most, float(np.max(np.abs(found - change))))
    print(f"largest difference to the replay: {most:.3f} levels")


def test_a_joint_that_arrived_from_the_other_side_leaves_nothing_to_be_named() -> None:
    """Readings of a replay in which joint 2 came from the other side, and so rests as if it had been thrown forward."""
    linear = linearised(made(LOADS, seed=5))
    segments = []
    for segment in linear.segments:
        q = segment.motion.q.copy()
        q[0, 1] = 2 * q[1, 1] - q[0, 1]
        segments.append(replace(segment, motion=replace(segment.motion, q=q)))
    other = Replay(linear.replay.compiled, tuple(segments), linear.quantities)
    shift = linear.whiten(other.predict(NOMINAL) - linear.replay.predict(NOMINAL))
    without, with_it = (0.5 * chi_square_left(linear, shift, *names) for names in (("as it arrived",), ()))
    print(f"{without:.1f} nats without, {with_it:.1f} with a side from which links arrive")
    assert without > np.log(100)  # odds that a cause would have been given
    assert with_it < np.log(100)


def test_a_link_that_its_friction_holds_anywhere_has_no_side_from_which_it_arrives() -> None:
    """Joint 1 turns about the vertical: nothing loads it. With that freedom a play in it was named softening."""
    linear = linearised(made(LOADS, seed=5))
    names = [one.name for one in linear.nuisances]
    third, first = (names.index(f"link-side friction held at rest by joint{j} as it arrived") for j in (3, 1))
    assert np.any(linear.sensitivities[:, :, third])
    assert not np.any(linear.sensitivities[:, :, first])
