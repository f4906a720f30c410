"""The second plant on a robot of the bench: its model and a session as plain numbers, and a campaign of it."""

from collections.abc import Iterable, Sequence

import mujoco
import numpy as np

from bench.effects.drifts import DAY_K, VISCOUS, own_shares
from bench.effects.effect import Acting, Place
from bench.effects.places import torque_limit
from bench.effects.recording_places import FORCE, GAUGE, TRACKER
from bench.hide.campaign import reduced
from bench.hide.plan import Leg, legs_of
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot
from bench.robot.links import rigid_bodies
from bench.scenario.files import Experiment
from bench.second.campaign import Hiding, Second, hide_in_second
from bench.second.course import Sitting
from bench.second.figures import Array, Figures, Friction, Gas, Lump, Servo, Spot, Springs
from bench.second.machine import Machine
from bench.second.readout import Readout
from bench.second.worlds import QUIET, World
from bench.simulate.env import CONTROL_PERIOD


def run_second(
    robot: Robot,
    session: Experiment,
    acting: Sequence[Acting],
    rng: np.random.Generator,
    *,
    world: World = QUIET,
    quiet: bool = False,
    without: Iterable[str] = (),
    machine: np.random.Generator | None = None,
) -> Second:
    """Run a session on the second plant of a robot.

    Args:
        robot: The nominal robot.
        session: What to do.
        acting: Effects that act, of the catalogue or unlisted; see `bench.second.effects.CHANGES`.
        rng: Source of all errors and noise.
        world: How friction and servos are.
        quiet: Nothing nominal is wrong, and the instruments are perfect.
        without: Instruments, channels and parts of the session that the lab does not have, as in `hide_campaign`.
        machine: Source of what is wrong with the machine itself and with its lab, as in `hide_campaign`; what drifts or
            is set up anew comes from `rng`, as `effects/drifts.py` says. None: all of it comes from `rng`.

    Raises:
        ConvergenceError: It finds no balance.
        InputError: It does not know an effect, or the session does not fit the robot.
    """
    robot, session, shown = reduced(robot, session, tuple(without), ())
    compiled = compile_robot(robot)
    hidings = tuple(Hiding(one.effect.name, _where(one.place), one.effect.complete(one.values)) for one in acting)
    sittings = sittings_of(legs_of(robot, session))
    lasting = Machine(machine, own_shares(robot.figures), VISCOUS * DAY_K) if machine else None
    return hide_in_second(
        robot.name,
        figures_of(compiled),
        robot.figures,
        sittings,
        hidings,
        rng,
        world=world,
        quiet=quiet,
        thermometers=shown,
        machine=lasting,
    )


def _where(place: Place) -> int | str:
    """Return the index of a drive, also of its channel, or the name of a body or another instrument."""
    is_named = place.kind == "body" or place in (TRACKER, GAUGE, FORCE)
    return place.name if is_named else place.index


def sittings_of(legs: Sequence[Leg]) -> tuple[Sitting, ...]:
    """Return a session's sittings as plain numbers."""
    found, now = [], 0.0
    for i, leg in enumerate(legs):
        now += leg.pause_s if i else 0.0
        course = leg.course
        marks = [step.mark for step in course.steps if step.mark]
        found.append(
            Sitting(
                start=course.start,
                commands=course.commands,
                wrenches=course.wrenches,
                period=CONTROL_PERIOD,
                ends=now + course.ends,
                marked=course.marked,
                runs=tuple(mark.run for mark in marks),
                labels=tuple(mark.labels for mark in marks),
                payload_kg=leg.payload_kg,
            )
        )
        now += course.seconds
    return tuple(found)


def figures_of(compiled: CompiledRobot) -> Figures:
    """Return a robot's nominal figures as plain numbers; all its driven joints are hinges."""
    model, at, bodies = compiled.model, compiled.at, rigid_bodies(compiled)
    figures, balance, gauge = (
        compiled.robot.figures,
        compiled.counterbalance,
        compiled.robot.figures.instruments.pressure,
    )
    nothing = np.zeros(compiled.n_joints)
    limit = np.array([torque_limit(compiled, i) for i in range(compiled.n_joints)])
    kp = -model.actuator_biasprm[at.servo, 1]
    points = bodies.points
    load, *reflectors = (
        Spot(points[name].body, points[name].position, points[name].rotation)
        for name in (figures.load_point, *figures.reflectors)
    )
    return Figures(
        parent=bodies.parent,
        position=bodies.position,
        rotation=bodies.rotation,
        axis=bodies.axis,
        lumps=_lumps(compiled),
        load=load,
        reflectors=tuple(reflectors),
        gravity=bodies.gravity,
        springs=Springs(compiled.stiffness, nothing, limit, nothing),
        motor=Friction.plain(compiled.motor_coulomb, compiled.motor_presliding),
        link=Friction.plain(compiled.link_coulomb, compiled.link_presliding),
        servo=Servo(kp, model.actuator_gainprm[at.servo, 0] / kp),
        gas=Gas(
            balance.joint,
            balance.rho,
            balance.b,
            balance.dead_centre,
            balance.gas_constant,
            balance.critical_length,
            gauge.piston_area_m2 if gauge else float("nan"),
        )
        if balance
        else None,
        rotor_inertia=np.array(model.dof_armature[at.q_dof]),
        viscous=np.array(model.dof_damping[at.q_dof]),
        torque_limit=limit,
        readout=Readout.perfect(compiled.n_joints),
    )


def _lumps(compiled: CompiledRobot) -> tuple[Lump, ...]:
    """Return every moving body that has a mass, in the frame of the driven joint that moves it."""
    model, at = compiled.model, compiled.at
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)  # with all joints at zero
    own = {int(model.jnt_bodyid[j]): i for i, j in enumerate(at.joint)}
    found = []
    for body in range(1, model.nbody):
        carrier = body
        while carrier and carrier not in own:
            carrier = int(model.body_parentid[carrier])
        if not carrier or model.body_mass[body] == 0:
            continue
        joint = own[carrier]
        axes = _matrix(data.xmat[carrier])
        com = axes.T @ (data.xipos[body] - data.xanchor[at.joint[joint]])
        main = axes.T @ _matrix(data.ximat[body])
        inertia = main @ np.diag(model.body_inertia[body]) @ main.T
        turned = axes.T @ _matrix(data.xmat[body])
        found.append(Lump(str(model.body(body).name), joint, float(model.body_mass[body]), com, inertia, turned))
    return tuple(found)


def _matrix(flat: Array) -> Array:
    return np.array(flat).reshape(3, 3)
