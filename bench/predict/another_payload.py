"""Another payload than the one that a model carries, for recordings in which something else was bolted on."""

from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.effect import Array, Conditions, Effect, Parameter, Place, Values
from bench.effects.masses import LIGHTEST
from bench.effects.payloads import PayloadCom, UnstatedPayload, rated_lever
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.folder import Robot

_MASS, _INERTIA = UnstatedPayload.parameters[:2]


class AnotherPayload(Effect):
    """What is bolted to the load point is another body than the model's."""

    name = "another_payload"
    family = "geometry and mass"
    title = "another payload"
    physics = (
        "Mass, centre of mass (in the axes of the load body) and moment of inertia about every axis of what the model "
        "carries at the load point change by m, (x, y, z) and J; what the campaign states is beside it."
    )
    source = UnstatedPayload.source
    parameters = (
        replace(_MASS, words="m; range as a part of the largest payload that may be there", signed=True),
        replace(_INERTIA, words="J; range for a largest mass of 1 kg", signed=True),
        *(replace(p, words=f"shift along {p.name}") for p in PayloadCom.parameters),
    )

    def parameters_at(self, compiled: CompiledRobot, place: Place) -> tuple[Parameter, ...]:
        """Return the parameters with the range of a robot; no more is taken away than it carries."""
        mass, inertia = _carried(compiled)
        stated = {p.name: p for p in UnstatedPayload().parameters_at(compiled, place)}
        least = {"mass": LIGHTEST * mass, "inertia": LIGHTEST * inertia}
        return tuple(
            replace(p, low=stated[p.name].low, high=stated[p.name].high, least=least[p.name])
            if p.name in stated
            else replace(p, high=max(p.high, rated_lever(compiled)))
            for p in self.parameters
        )

    def edit(self, place: Place, values: Values, conditions: Conditions) -> SpecEdit | None:
        """Return the change of the body that the model carries."""
        mass, inertia = values["mass"], values["inertia"]
        shift = np.array([values[axis] for axis in "xyz"])

        def change(spec: mujoco.MjSpec, robot: Robot) -> None:
            carried = _payload_in(spec, robot)
            carried.mass = carried.mass + mass
            carried.inertia = np.array(carried.inertia) + inertia
            if carried.name != robot.figures.load_body:  # wrenches act where the load body's centre of mass is
                carried.pos = np.array(carried.pos) + shift

        return change if mass or inertia or np.any(shift) else None


def _payload_in(spec: mujoco.MjSpec, robot: Robot) -> mujoco.MjsBody:
    """Return the body that a model carries at the load point; the massless load body itself if there is none."""
    load = spec.body(robot.figures.load_body)
    return max([load, *load.bodies], key=lambda body: float(body.mass))


def _carried(compiled: CompiledRobot) -> tuple[float, float]:
    """Return mass [kg] and smallest moment of inertia [kg m^2] of what a model carries at the load point."""
    model = compiled.model
    load = model.body(compiled.robot.figures.load_body).id
    bodies = [load, *(body for body in range(model.nbody) if model.body_parentid[body] == load)]
    heaviest = max(bodies, key=lambda body: float(model.body_mass[body]))
    inertia: Array = model.body_inertia[heaviest]
    return float(model.body_mass[heaviest]), float(np.min(inertia))
