"""What is bolted to the load point: heavier or elsewhere than stated, or not stated at all."""

from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Array, Parameter, Place, Values
from bench.effects.masses import LIGHTEST, SWEVERS, GeometryAndMass, scale_mass, vector_of
from bench.effects.parameter import Quotient
from bench.errors import RobotError
from bench.record.units import STANDARD_GRAVITY
from bench.robot.compiled import CompiledRobot, SpecEdit, read_spec
from bench.robot.folder import Robot
from bench.robot.moments_of_inertia import moments_of_inertia, second_moments
from bench.robot.plugins import added_body, unused_name

UNSTATED = "unstated payload"  # of the body that is bolted on
COMPACT_M, BULKY_M = 0.05, 0.6  # assumed: [m], radii of gyration of a steel block and of a bulky workpiece
LIGHT = 0.01  # assumed: of the largest payload; what is lighter is a part of a tool
# derived: [m], centre of a uniform rod from its end, which is bolted on: L/2 with k = L/sqrt(12)
FARTHEST_M = 3**0.5 * BULKY_M


class PayloadMass(GeometryAndMass):
    """What is bolted on is heavier or lighter than written down."""

    name = "payload_mass"
    title = "mass of the payload"
    between = "anew"
    physics = "The mass bolted to the load point is (1 + x) of what the lab states; weights that hang are not meant."
    source = f"{SWEVERS}; range: design of this project, 1 to 10 %"
    parameters = (Parameter("change", "", 0.0, 0.01, 0.1, "of the mass, relative", signed=True, least=LIGHTEST),)

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        change = values["change"]

        def edit(spec: mujoco.MjSpec, robot: Robot) -> None:
            scale_mass(spec.body(robot.figures.load_body), 1 + change)

        return edit if change else None


def _second_moment(axis: str) -> Parameter:
    others = [other for other in "xyz" if other != axis]
    return Parameter(
        f"second_moment_{axis}",
        "kg m^2",
        0.0,
        LIGHT * COMPACT_M**2 / 2,
        BULKY_M**2 / 2,
        f"S_{axis}, part of {' and '.join(f'J_{other}' for other in others)}; range for a largest mass of 1 kg",
    )


def _first_moment(axis: str) -> Parameter:
    return Parameter(
        f"moment_{axis}",
        "kg m",
        0.0,
        LIGHT * COMPACT_M,
        1.0,
        f"s_{axis}; range for a largest mass of 1 kg, whose weight has the rated moment with a lever of 1 m",
        signed=True,
        quotient=Quotient("mass", axis, "m", f"centre of mass beside the load point along {axis}, s_{axis}/m"),
    )


class UnstatedPayload(GeometryAndMass):
    """The robot carries something that nobody wrote down."""

    name = "unstated_payload"
    title = "payload that is not stated"
    between = "anew"
    covers = ("payload_mass", "payload_com")
    physics = (
        "A body is bolted on beside what the campaign states: mass m, centre of mass s/m from the load point in the "
        f"axes of the load body (no farther than {FARTHEST_M:.2f} m), second moments S of its mass along these axes "
        "about its centre (integrals of x^2 dm, never below zero), which make its moments of inertia J_x = S_y + S_z "
        "and so on; no products of inertia. To a payload that the model has already, m, s and S are added."
    )
    source = (
        f"{SWEVERS} (payload identification by first moments); range: up to `uncertainty.payload_kg` of the robot's "
        "figures, by default the rated load; first moments up to the rated moment, as load diagrams have it (ABB IRB "
        "4600: 60 kg up to 0.18 m beyond and 0.2 m beside the flange)"
    )
    parameters = (
        Parameter("mass", "kg", 0.0, LIGHT, 1.0, "m; range as a part of the largest payload that may be there"),
        *(_second_moment(axis) for axis in "xyz"),
        *(_first_moment(axis) for axis in "xyz"),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the robot, unless its figures say that no recording leaves a payload unstated."""
        return (WHOLE,) if _largest_payload(compiled) > 0 else ()

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameters with the range of a robot."""
        largest, lever = _largest_payload(compiled), rated_lever(compiled)
        return tuple(
            replace(p, low=largest * p.low, high=largest * p.high * (lever if p.quotient else 1.0))
            for p in self.parameters
        )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        mass, moment, second = values["mass"], vector_of(values, "moment_"), vector_of(values, "second_moment_")

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            load = spec.body(robot.figures.load_body)
            carried = added_body(spec, UNSTATED)
            if carried is None:
                if mass < 0:
                    raise RobotError(f"body {load.name!r}: carries nothing that nobody stated, of which to take away")
                # a body of its own: the load body's centre of mass has to stay in the load point, where wrenches act
                carried = load.add_body(name=unused_name(spec, UNSTATED), pos=np.array(load.ipos))
                carried.mass, carried.inertia, carried.explicitinertial = 0.0, np.zeros(3), True
                carried.ipos, carried.iquat = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
            before, at = float(carried.mass), np.array(load.ipos)
            there = np.array(carried.pos) + np.array(carried.ipos) - at  # a fit moves its centre of mass in its frame
            carried.mass = max(before + mass, 0.0)
            carried.pos = at + _centre(carried.mass, before * there + moment)
            carried.ipos = np.zeros(3)
            carried.inertia = moments_of_inertia(np.maximum(second_moments(carried.inertia) + second, 0.0))

        return change if mass or np.any(second) else None

    def there_already(self, compiled: CompiledRobot, place: Place) -> Mapping[str, float]:
        """Return mass and second moments of what a model carries and nobody stated."""
        carried = added_body(read_spec(compiled.robot), UNSTATED)
        if carried is None:
            return {}
        second = dict(zip("xyz", second_moments(carried.inertia).tolist(), strict=True))
        return {"mass": float(carried.mass)} | {f"second_moment_{axis}": value for axis, value in second.items()}


def _centre(mass: float, moment: Array) -> Array:
    """Return where a body with a first moment [kg m] has its centre, shape (3,) [m]; no farther than bodies go."""
    length = float(np.linalg.norm(moment))
    if length == 0 or mass == 0:
        return np.zeros(3)
    centre: Array = moment / max(mass, length / FARTHEST_M)
    return centre


def rated_lever(compiled: CompiledRobot) -> float:
    """Return how far from the load point the rated load may have its centre [m]: rated moment by rated force."""
    rating = compiled.robot.figures.rating
    return rating.moment_nm / rating.force_n


def carrying_nothing(robot: Robot) -> Robot:
    """Return a robot without the payload that nobody stated and a diagnosis found in one recording of it.

    What a machine carries is another thing in the next recording, heavier or lighter.
    """
    carried = added_body(read_spec(robot), UNSTATED)
    return replace(robot, not_carried=(*robot.not_carried, carried.name)) if carried else robot


def _largest_payload(compiled: CompiledRobot) -> float:
    """Return the largest payload that a recording may leave unstated [kg]."""
    figures = compiled.robot.figures
    stated = figures.uncertainty.payload_kg
    return figures.rating.force_n / STANDARD_GRAVITY if stated is None else stated


class PayloadCom(GeometryAndMass):
    """The payload's centre of mass is not in the load point."""

    name = "payload_com"
    title = "centre of mass of the payload"
    between = "anew"
    physics = (
        "The mass bolted on hangs beside the load point by (x, y, z) in the axes of the load body: moment m g x offset."
    )
    source = f"{SWEVERS}; range: design of this project, 5 to 30 mm"
    parameters = tuple(Parameter(axis, "m", 0.0, 5e-3, 30e-3, f"offset along {axis}", signed=True) for axis in "xyz")

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        offset = vector_of(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            load = spec.body(robot.figures.load_body)
            if load.mass == 0:
                return
            # a body of its own: the load body's centre of mass has to stay in the load point, where wrenches act
            moved = load.add_body(name=unused_name(spec, "payload"), pos=np.array(load.ipos) + offset)
            moved.mass, moved.inertia, moved.explicitinertial = load.mass, np.array(load.inertia), True
            moved.ipos, moved.iquat = np.zeros(3), np.array(load.iquat)
            load.mass, load.inertia, load.explicitinertial = 0.0, np.zeros(3), True

        return change if np.any(offset) else None
