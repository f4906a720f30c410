"""Another payload than the one that a model carries, for recordings in which something else was bolted on."""

from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Effect, Parameter, Place, Values
from bench.effects.masses import LIGHTEST, vector_of
from bench.effects.payloads import PayloadCom, UnstatedPayload, rated_lever
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot
from bench.robot.moments_of_inertia import moments_of_inertia, second_moments

_MASS, *_SECOND = UnstatedPayload.parameters[:4]


class AnotherPayload(Effect):
    """What is bolted to the load point is another body than the model's."""

    name = "another_payload"
    family = "geometry and mass"
    title = "change of the payload"
    physics = (
        "Mass, centre of mass (in the axes of the load body) and second moments of mass (along its principal axes) of "
        "what the model carries at the load point change by m, (x, y, z) and S; what the campaign states is beside it."
    )
    source = UnstatedPayload.source
    parameters = (
        replace(_MASS, words="m; range as a part of the largest payload that may be there", signed=True),
        *(replace(one, signed=True) for one in _SECOND),
        *(replace(p, words=f"shift along {p.name}") for p in PayloadCom.parameters),
    )

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the robot, unless its figures say that no recording leaves a payload unstated."""
        return UnstatedPayload().places(compiled)

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameters with the range of a robot; no more is taken away than it carries."""
        body = _carried(compiled)
        mass, second = float(compiled.model.body_mass[body]), second_moments(compiled.model.body_inertia[body])
        stated = {p.name: p for p in UnstatedPayload().parameters_at(compiled, place)}
        has = {p.name: value for p, value in zip(_SECOND, second.tolist(), strict=True)} | {"mass": mass}
        least = {name: LIGHTEST * value for name, value in has.items()}
        return tuple(
            replace(p, low=stated[p.name].low, high=stated[p.name].high, least=least[p.name])
            if p.name in stated
            else replace(p, high=max(p.high, rated_lever(compiled)))
            for p in self.parameters
        )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        """Return the change of the body that the model carries."""
        mass, second, shift = values["mass"], vector_of(values, "second_moment_"), vector_of(values)

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            carried = _payload_in(spec, robot)
            carried.mass = carried.mass + mass
            carried.inertia = moments_of_inertia(np.maximum(second_moments(carried.inertia) + second, 0.0))
            if carried.name != robot.figures.load_body:  # wrenches act where the load body's centre of mass is
                carried.pos = np.array(carried.pos) + shift

        return change if mass or np.any(second) or np.any(shift) else None


CARRIED_MASS = f"{AnotherPayload.title}: mass"  # of `carried_by`


def _payload_in(spec: mujoco.MjSpec, robot: Robot) -> mujoco.MjsBody:
    """Return the body that a model carries at the load point; the massless load body itself if there is none."""
    load = spec.body(robot.figures.load_body)
    return max([load, *load.bodies], key=lambda body: float(body.mass))


def carried_by(compiled: CompiledRobot) -> Mapping[str, float]:
    """Return name of a fitted figure -> what a model has of it: mass [kg] and centre [m] of its payload.

    The centre is in the axes of the load body. Second moments are left out: what is stated of them hangs on the axes of
    the body; so is the centre of a payload that is the load body itself.
    """
    model, body = compiled.model, _carried(compiled)
    known = {"mass": float(model.body_mass[body])}  # `CARRIED_MASS`
    if body != model.body(compiled.robot.figures.load_body).id:
        turned = np.zeros(3)
        mujoco.mju_rotVecQuat(turned, model.body_ipos[body], model.body_quat[body])
        known |= dict(zip("xyz", (model.body_pos[body] + turned).tolist(), strict=True))
    return {f"{AnotherPayload.title}: {name}": value for name, value in known.items()}


def _carried(compiled: CompiledRobot) -> int:
    """Return the body that a model carries at the load point; the load body itself if there is none."""
    model = compiled.model
    load = model.body(compiled.robot.figures.load_body).id
    bodies = [load, *(body for body in range(model.nbody) if model.body_parentid[body] == load)]
    return int(max(bodies, key=lambda body: float(model.body_mass[body])))
