"""What is asked before a verdict and proposed after it: healthy channels are believed, broken ones are not."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.diagnose.experiment_design.new_instruments import noise_of_new
from bench.diagnose.experiment_design.preposterior import Expectation, narrowing
from bench.diagnose.experiment_design.propose import LEAST_NARROWING
from bench.diagnose.plausibility.channels import _of_drive
from bench.diagnose.plausibility.displaced import _away, _most, _pressure, _reflector, _stopped
from bench.diagnose.plausibility.drive_looks import drive_looks
from bench.diagnose.plausibility.mistaken import mistakes_in
from bench.diagnose.plausibility.reported_torques import unlike_currents
from bench.diagnose.plausibility.single_rows import BEYOND
from bench.diagnose.plausibility.speeds import least_top_speed
from bench.diagnose.plausibility.unstated_loads import _shown, _Visit
from bench.diagnose.replay.quantities import Quantity
from bench.effects.places import torque_limit
from bench.record.campaign import Array, Campaign, Run
from tests.diagnose.assumed.registry import needs
from tests.diagnose.sweeps import nominal
from tests.diagnose.two_drives import picture_of

JOINT = 1
CURRENT = Quantity("current_2_a", "current", "A", JOINT)
TIME = np.linspace(0.0, 2 * np.pi, 401)[:-1]
# even harmonics: no friction of a drive that goes with cos(t) makes them, and none of them makes another
SECOND, FOURTH, SIXTH = (np.sin(n * TIME) for n in (2, 4, 6))
MOVES = np.cos(TIME)[:, None] * np.ones(2)
AXES = ["reflector_1_x_m", "reflector_1_y_m", "reflector_1_z_m"]


def is_called_exchanged(differ: float, left: float = 0.0) -> bool:
    """Return whether two drives are that have each other's channel.

    Args:
        differ: Mean square of the difference between what they need, as a part of what they need.
        left: What the right order leaves, as a part of that.
    """
    share = 1 - differ / 2
    model = np.stack([SECOND, share * SECOND + (1 - share**2) ** 0.5 * FOURTH], axis=1)
    observed = model[:, ::-1] + (left * differ) ** 0.5 * SIXTH[:, None]
    found = list(mistakes_in(picture_of(observed, model, MOVES)))
    assert all("are exchanged" in doubt.message for doubt in found)
    return bool(found)


@needs("plausibility.physical_fit.FITS")
def a_model_that_misses_a_fifth_of_a_torque_is_no_reason_to_doubt_a_channel() -> None:
    # Nor are two drives that need nearly the same. Where it misses 28 %, another reading is looked for.
    assert not is_called_exchanged(0.20**2)
    assert is_called_exchanged(0.28**2)


@needs("plausibility.physical_fit.FAR_BETTER")
def what_leaves_a_fourteenth_is_the_right_reading_and_what_leaves_a_sixth_is_not() -> None:
    assert is_called_exchanged(0.4, left=1 / 14)
    assert not is_called_exchanged(0.4, left=1 / 6)


@needs("plausibility.drive_looks.TOLD")
def a_part_as_small_as_errors_of_masses_tells_no_gain() -> None:
    # The model misses 1.4 % of what motion needs: of gravity as small that would make a factor of two.

    def told(part: float) -> bool:
        observed = 1.014 * SECOND
        gravity = part * (SECOND + FOURTH) / 2**0.5
        both = np.stack([observed + gravity, SECOND], axis=1)
        looks = drive_looks(
            picture_of(both, np.stack([SECOND + gravity, SECOND], axis=1), MOVES), gravity[:, None] * [1, 0]
        )
        return bool(np.isfinite(looks[0].gravity.value))

    assert not told(0.014)
    assert told(0.028)


@needs("plausibility.drive_picture.HELD")
def friction_of_a_standing_drive_is_no_load_that_was_forgotten() -> None:
    # Some 5 % of its limit, and half more at rest, is friction; 15 % is something that hangs there.

    def words(share: float) -> str:
        held = share * torque_limit(nominal(), JOINT) / abs(nominal().torque_constant[JOINT])
        visit = _Visit("run", np.arange(2.0), np.zeros((2, 3)), np.array([[0.0], [held]]), {})
        return _shown(visit, nominal(), (CURRENT,))

    assert words(0.08) == ""
    assert "more than friction holds" in words(0.15)


@needs("plausibility.channels.FEEBLE")
def a_counterbalance_may_hold_most_of_a_torque_and_no_gear_is_so_small() -> None:
    # A seventh of what a drive needs may be left beside a spring, a fifteenth may not.

    def is_too_small(share: float) -> bool:
        picture = picture_of(np.stack([share * SIXTH, SIXTH], axis=1), np.stack([SECOND, SECOND], axis=1), MOVES)
        found = _of_drive(picture, nominal(), 0, np.ones(len(TIME), dtype=np.bool_))
        return any("times smaller than what" in doubt.message for doubt in found)

    assert not is_too_small(1 / 7)
    assert is_too_small(1 / 15)


def places(spread: float = 1.0) -> Array:
    """Return where a reflector goes, shape (T, 3), so far from its middle [m] rms."""
    there: Array = spread * np.stack([np.cos(TIME), np.sin(TIME), np.zeros(len(TIME))], axis=1)
    return there


def replay_with(geometry_m: float) -> Any:
    """Return a robot that is replayed, of which places are known so well [m]."""
    figures = SimpleNamespace(uncertainty=SimpleNamespace(geometry_m=geometry_m))
    return SimpleNamespace(compiled=SimpleNamespace(robot=SimpleNamespace(figures=figures)))


def is_far(off: float, geometry_m: float) -> bool:
    """Return whether something is said of a reflector that is so far off [m], and near enough to be used."""
    return bool(list(_away(AXES, places() + np.array([0, 0, off]), places(), _most(replay_with(geometry_m)))))


@needs("plausibility.displaced.AWAY")
def a_tracker_may_jump_by_millimetres_and_no_calibrated_arm_is_off_by_fourteen() -> None:
    assert not is_far(0.007, 0.2e-3)
    assert is_far(0.014, 0.2e-3)


@needs("plausibility.displaced.STATED")
def seven_places_may_be_off_in_one_direction_and_not_all_by_two_standard_errors() -> None:
    assert not is_far(7 * 3e-3, 3e-3)
    assert is_far(14 * 3e-3, 3e-3)


@needs("plausibility.displaced.FAR")
def a_reflector_of_a_rough_model_is_used_and_one_of_another_frame_is_not() -> None:
    # Seven centimetres are left to a diagnosis, fifteen are no model of this robot.

    def is_doubted(off: float) -> bool:
        return bool(list(_reflector(AXES[0], [0, 1, 2], places() + np.array([0, 0, off]), places(), 2e-3)))

    assert not is_doubted(0.07)
    assert is_doubted(0.15)


@needs("plausibility.displaced.SCALE")
def links_of_a_rough_model_are_longer_by_less_than_a_percent() -> None:
    def is_doubted(factor: float) -> bool:
        return bool(list(_reflector(AXES[0], [0, 1, 2], factor * places(), places(), 2e-3)))

    assert not is_doubted(1.007)
    assert is_doubted(1.015)


@needs("plausibility.displaced.GAS")
def gas_that_was_lost_or_overfilled_is_believed_and_no_unit_is() -> None:
    # A charge may be at 40 % or at 240 %; pressures of another kind are off by more.
    model = np.full(10, 8e6)
    for factor, doubts in ((0.4, 0), (2.4, 0), (0.22, 1), (4.5, 1)):
        assert len(list(_pressure(factor * model, model))) == doubts


@needs("plausibility.displaced.STANDS")
def a_channel_that_begins_late_is_not_frozen_and_one_that_stops_for_a_third_of_a_run_is() -> None:
    class Stretch:
        run = "sweep"

        def __len__(self) -> int:
            return len(TIME)

    def is_frozen(share: float) -> bool:
        replay = replay_with(0.2e-3)
        replay.segments, replay.quantities = [Stretch()], (Quantity(AXES[0], "reflector", "m"),)
        replay.compiled.robot.figures.instruments = SimpleNamespace(pressure=None)
        there = 0.1 * TIME[:, None]
        return bool(_stopped(replay, np.maximum(there, there[int(share * len(TIME))]), there))

    assert not is_frozen(0.18)
    assert is_frozen(0.35)


@needs("plausibility.reported_torques.NOTHING")
def a_drive_that_stands_may_report_its_offset() -> None:
    # Without a current, seven thousandths of its limit are an offset, and fifteen are a torque in another unit.

    def is_told(share: float) -> bool:
        torque = np.full(50, share * torque_limit(nominal(), JOINT))
        run = Run("rest", "motion", 0.0, {"current_2_a": np.zeros(50), "tau_motor_2_nm": torque})
        return bool(list(unlike_currents(Campaign("hh150", (run,)), nominal())))

    assert not is_told(0.007)
    assert is_told(0.015)


@needs("plausibility.speeds.PARTS")
def angles_that_are_renewed_late_look_no_faster_and_a_short_motion_shows_its_speed() -> None:
    rows, speed = np.arange(400), 1.0  # [rad/s], a row each millisecond

    def seen(moved: Array) -> float:
        """Return the speed of an angle that has moved for so many rows, shape (400,)."""
        return least_top_speed(
            Run("a", "motion", 0.0, {"time_s": 1e-3 * rows, "q_motor_1_rad": speed * 1e-3 * moved}), 1
        )

    assert seen(rows // 30 * 30) < BEYOND * speed  # of a controller that renews them 33 times a second
    assert seen(np.clip(rows - 200, 0, 27)) > 0.8 * speed


@needs("experiment_design.preposterior.SLOPE_ERROR")
def slopes_that_differ_by_a_percent_tell_no_two_things_apart() -> None:
    # Of two sizes only the sum is known. A precise experiment sees both, and one by a little more than the other.

    def narrows(more: float) -> float:
        covariance = np.array([[1.0, -1.0], [-1.0, 1.0]]) + 1e-6 * np.eye(2)
        return narrowing(Expectation(np.zeros(1), 1e4 * np.array([[1.0, 1.0 + more]]), covariance), 0)

    assert narrows(0.012) > LEAST_NARROWING  # it is not proposed
    assert narrows(0.04) < LEAST_NARROWING


@needs("experiment_design.new_instruments.RING")
def an_encoder_that_is_put_onto_a_link_sees_what_thirty_newton_metres_twist_and_not_twenty() -> None:
    sigma = noise_of_new(Quantity("q_link_3_rad", "q_link", "rad", 2), nominal())
    stiffest = np.max(nominal().stiffness)
    assert 20.0 / stiffest / sigma < 3.0 < 30.0 / stiffest / sigma
