"""Which of the fitted effects stand in the MJCF, and which beside it in `figures.yaml`."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Acting, Effect, Place
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot, SpecEdit, read_spec
from bench.robot.folder import Robot
from bench.robot.mass_matrix import mass_matrix
from bench.robot.plugins import unused_name
from bench.simulate.payload import bolt_on

G = 9.81  # exact: [m/s^2], to two digits; turns the rated force into a payload to try with
SAME = 1e-9  # rounding: relative, of inertia and gravity torques of one and the same robot; 1e-13 is rounding


@dataclass(frozen=True)
class Division:
    """Effects that act, divided by where they are written down.

    Attributes:
        in_model: In the MJCF.
        beside: In `figures.yaml`: what acts on readings, encoders or a campaign's payload, or with temperatures.
    """

    in_model: tuple[Acting, ...]
    beside: tuple[Acting, ...]


def divided(compiled: CompiledRobot, acting: Sequence[Acting]) -> Division:
    """Divide effects that act; an MJCF holds what changes the model alike under all conditions and with any payload."""
    in_model: list[Acting] = []
    beside: list[Acting] = []
    for one in acting:
        (in_model if _is_of_model(compiled, one) else beside).append(one)
    return Division(tuple(in_model), tuple(beside))


def payload_as_body(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Move what an effect gave the load body into a body of its own: campaigns say what is bolted on beside it."""
    load = spec.body(robot.figures.load_body)
    if load.mass == 0:
        return
    added = load.add_body(name=unused_name(spec, "payload"), pos=np.array(load.ipos))
    added.mass, added.inertia, added.explicitinertial = load.mass, np.array(load.inertia), True
    added.ipos, added.iquat = np.zeros(3), np.array(load.iquat)
    load.mass, load.inertia, load.explicitinertial = 0.0, np.zeros(3), True


def _is_of_model(compiled: CompiledRobot, acting: Acting) -> bool:
    kind, place = type(acting.effect), acting.place
    if place != Place(place.kind, place.index, place.name):  # it acts now and then
        return False
    if kind.edit is Effect.edit or kind.distort is not Effect.distort or kind.encoder_error is not Effect.encoder_error:
        return False
    if acting.effect.depends_on_conditions or kind.phase is not Effect.phase:
        return False
    payload_kg = compiled.robot.figures.rating.force_n / G
    n = compiled.n_joints
    then = acting.effect.edit(acting.place, acting.values, Conditions.reference(n, payload_kg))
    always = acting.effect.edit(acting.place, acting.values, Conditions.reference(n))
    as_acting = _loads(compiled, [bolt_on(payload_kg), *([then] if then else [])])
    as_written = _loads(compiled, [*([always] if always else []), payload_as_body, bolt_on(payload_kg)])
    return as_acting.shape == as_written.shape and bool(
        np.all(np.abs(as_acting - as_written) <= SAME * np.max(np.abs(as_acting)))
    )


def _loads(compiled: CompiledRobot, edits: Sequence[SpecEdit]) -> Array:
    """Return inertia matrix and gravity torques of the robot with some edits, at an angle that is no special one."""
    spec = read_spec(compiled.robot)
    for edit in edits:
        edit(spec, compiled.robot)
    for key in list(spec.keys):
        spec.delete(key)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = 0.1 * (1 + np.arange(model.nq))
    mujoco.mj_forward(model, data)
    return np.concatenate([mass_matrix(model, data).ravel(), data.qfrc_bias])
