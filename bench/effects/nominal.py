"""What is a little wrong in every nominal model: its figures, each with a stated uncertainty.

Diagnosis fits these first (nuisance parameters with priors); hidden-effect data draw their background errors from the
same list. Each parameter is a deviation from the nominal value; zero changes nothing. Torques are linear in masses,
inertias, levels of friction and the gas, which are off by a share of what is stated and may as good as vanish: a torque
sensor behind the gear feels no rotor. Links give by torque over stiffness, so a stiffness is known to a factor: one
standard deviation off it is 1 + sigma times as large or as small as stated, two of them off that squared. For a few per
cent that is the same; a stiffness that is known to a factor of a few stays a stiffness.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from bench.effects.figure_edits import (
    LEAST_SHARE,
    axis_turned,
    drag_scaled,
    joint_scaled,
    mass_scaled,
    mass_spread,
    place_shifted,
    plugin_scaled,
    plugin_shifted,
    stiffness_scaled,
)
from bench.effects.gas import CounterbalanceGas
from bench.effects.geometry_at_zero import across
from bench.robot.compiled import FRICTION, CompiledRobot, SpecEdit
from bench.robot.moments_of_inertia import second_moments

MOST_FACTOR = 1e3  # rounding: of a figure over what is stated of it; a gear a thousand times stiffer is rigid


@dataclass(frozen=True)
class NominalParameter:
    """One figure of the model that may be off.

    Attributes:
        name: What it is, for people.
        unit: "" for a share of what is stated, or what is known to a factor (`factor_of`).
        sigma: Its standard deviation as stated in the robot's figures.
        edit: From a deviation to the change of the model.
        is_factor: It is known to a factor.
        least: Least deviation.
        is_viscous: It is friction over speed (viscous, rolling, as learned), which follows the temperature of its oil.
        widened: Times that sigma is larger than what is stated of it (`uncertainty.links`).
        of_mass: It is the mass of a link, or where that sits: of what is there, not of what is bolted to it later.
        beside: Name of the effect without which it changes nothing in this robot; "": it always does.
        seen_by: Kind of reading that alone shows as little as it is off (`Quantity.kind`); "": any.
    """

    name: str
    unit: str
    sigma: float
    edit: Callable[[float], SpecEdit]
    is_factor: bool = False
    least: float = -np.inf
    is_viscous: bool = False
    widened: float = 1.0
    of_mass: bool = False
    beside: str = ""
    seen_by: str = ""

    def off_by(self, deviation: float) -> float:
        """Return by how much a deviation makes the figure larger than stated, in its unit; of a factor, as a share."""
        return factor_of(deviation, self.sigma) - 1 if self.is_factor else max(deviation, self.least)


def factor_of(deviation: float, sigma: float) -> float:
    """Return what a figure is times what is stated of it, (1 + sigma)^(deviation / sigma), `MOST_FACTOR` at most."""
    most = np.log(MOST_FACTOR)
    return float(np.exp(np.clip(np.log1p(sigma) * deviation / sigma, -most, most)))


def nominal_parameters(compiled: CompiledRobot) -> tuple[NominalParameter, ...]:
    """Return everything that may be a little wrong in the model of a robot, with a sigma above zero."""
    robot, model, known = compiled.robot, compiled.model, compiled.robot.figures.uncertainty
    of_drives = robot.figures.drive_uncertainty
    found: list[NominalParameter] = []
    for j, drive in enumerate(robot.figures.drives):
        joint, rotor, friction = drive.joint, drive.rotor, float(of_drives.friction[j])
        motor, link = drive.motor_friction, drive.link_friction
        found += [
            _share(f"motor-side Coulomb friction of {joint}", friction, plugin_scaled(motor, "coulomb")),
            _share(f"link-side Coulomb friction of {joint}", friction, plugin_scaled(link, "coulomb")),
            _share(f"rotor inertia of {joint}", float(of_drives.rotor_inertia[j]), joint_scaled(rotor, "armature")),
            replace(_share(f"viscous friction of {joint}", friction, joint_scaled(rotor, "damping")), is_viscous=True),
            _factor(f"stiffness of {joint}", float(of_drives.stiffness[j]), stiffness_scaled(drive.element)),
        ]
        if compiled.motor_rolling[j] > 0:
            rolls = _share(f"rolling friction of {joint}", friction, plugin_scaled(motor, "rolling"))
            found.append(replace(rolls, is_viscous=True))
        if compiled.motor_drag[j] != 0:
            learned = _share(f"learned friction over speed of {joint}", friction, drag_scaled(motor))
            found.append(replace(learned, is_viscous=True))
    for name in moving_bodies(compiled):
        if model.body(name).mass[0] > 0:
            found += [replace(one, of_mass=True) for one in _of_link(compiled, name)]
    for name in placed_bodies(compiled):
        found += [
            NominalParameter(f"place of {name}, {axis}", "m", known.geometry_m, place_shifted("body", name, "pos", i))
            for i, axis in enumerate("xyz")
        ]
    if balance := robot.figures.counterbalance:
        found += _of_cylinder(compiled, balance.actuator)
    for drive in robot.figures.drives:
        for i, lean in enumerate(across(model.joint(drive.joint).axis)):
            turned = axis_turned(drive.joint, lean)
            name = f"direction of the axis of {drive.joint}, across {i + 1}"
            found.append(NominalParameter(name, "rad", known.axis_rad, turned, seen_by="reflector"))
    return tuple(parameter for parameter in found if parameter.sigma > 0)


PRESLIDING = "presliding stiffness"


def presliding_parameters(compiled: CompiledRobot) -> tuple[NominalParameter, ...]:
    """Return how stiff the friction elements hold, of all that have a level, with a sigma above zero.

    Hardly any data sheet states it. At rest it says how much of its friction a link takes up again under a load. Not
    among the background errors of hidden campaigns: stiffer elements ask for another step of the plant in time.
    """
    sigma = compiled.robot.figures.uncertainty.presliding
    sides = (("motor", compiled.motor_coulomb), ("link", compiled.link_coulomb))
    return tuple(
        _factor(f"{PRESLIDING} on the {side} side of {drive.joint}", sigma, plugin_scaled(element, FRICTION[1]))
        for j, drive in enumerate(compiled.robot.figures.drives)
        for (side, level), element in zip(sides, (drive.motor_friction, drive.link_friction), strict=True)
        if sigma > 0 and level[j] > 0
    )


def _of_cylinder(compiled: CompiledRobot, actuator: str) -> Iterator[NominalParameter]:
    """Yield what is uncertain in a counterbalance: where no gas is stated, what will be once some is found.

    C is not, then: what is found is the charge relative to it (`CounterbalanceGas`), and the two are one number.
    """
    known, is_at_work = compiled.robot.figures.uncertainty, compiled.counterbalance is not None
    beside = "" if is_at_work else CounterbalanceGas.name
    if is_at_work:
        yield _share("gas constant C", known.gas_constant, plugin_scaled(actuator, "constant"))
    shifted = plugin_shifted(actuator, "critical_length")
    yield NominalParameter("critical length l_c", "m", known.critical_length_m, shifted, beside=beside)
    for site in _anchors(compiled):
        for i, axis in enumerate("xyz"):
            if i != _across(compiled):
                name = f"anchor {site}, {axis}"
                yield NominalParameter(
                    name, "m", known.geometry_m, place_shifted("site", site, "pos", i), beside=beside
                )


def _of_link(compiled: CompiledRobot, name: str) -> Iterator[NominalParameter]:
    """Yield what is uncertain in the mass of a link and where it sits.

    Who knows lengths to s knows a radius of gyration g to s, and the share of a second moment in m g^2 to sqrt(2) s / g
    (so the first pass takes it: an inertia to 2 m g s). It matters where links are known far worse than usual.
    """
    known = compiled.robot.figures.uncertainty
    length = known.links * known.centre_of_mass_m
    yield replace(_share(f"mass of {name}", known.links * known.mass, mass_scaled(name)), widened=known.links)
    for i, axis in enumerate("xyz"):
        one = NominalParameter(f"centre of mass of {name}, {axis}", "m", length, place_shifted("body", name, "ipos", i))
        yield replace(one, widened=known.links)
    body = compiled.model.body(name)
    second = second_moments(body.inertia)
    if known.links == 1 or second.sum() <= 0:
        return
    sigma = float(np.sqrt(2) * length / np.sqrt(second.sum() / body.mass[0]))
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, body.iquat)
    for i in range(3):
        least = LEAST_SHARE * float(second[i] / second.sum())
        edit = mass_spread(name, i, axes.reshape(3, 3))
        title = f"spread of the mass of {name} along its principal axis {i + 1}"
        yield NominalParameter(title, "", sigma, edit, least=least)


def _share(name: str, sigma: float, times: Callable[[float], SpecEdit]) -> NominalParameter:
    return NominalParameter(name, "", sigma, lambda x: times(1 + max(x, LEAST_SHARE)), least=LEAST_SHARE)


def _factor(name: str, sigma: float, times: Callable[[float], SpecEdit]) -> NominalParameter:
    return NominalParameter(name, "", sigma, lambda x: times(factor_of(x, sigma)), is_factor=True)


def moving_bodies(compiled: CompiledRobot) -> tuple[str, ...]:
    """Return the names of the bodies that driven joints move, rotors left out, in the order of the model."""
    model = compiled.model
    moved = set(model.jnt_bodyid[compiled.at.joint].tolist())
    names = []
    for body in range(1, model.nbody):
        if body in moved or int(model.body_parentid[body]) in moved:
            moved.add(body)
            names.append(str(model.body(body).name))
    return tuple(names)


def placed_bodies(compiled: CompiledRobot) -> tuple[str, ...]:
    """Return the names of the bodies whose place in their parent counts: those with a driven joint or a reflector."""
    model, at = compiled.model, compiled.at
    bodies = {*model.jnt_bodyid[at.joint].tolist(), *model.site_bodyid[at.reflectors].tolist()}
    return tuple(name for name in moving_bodies(compiled) if int(model.body(name).id) in bodies)


def _anchors(compiled: CompiledRobot) -> tuple[str, ...]:
    model, tendon = compiled.model, compiled.at.counterbalance_tendon
    start = model.tendon_adr[tendon]
    return tuple(str(model.site(int(site)).name) for site in model.wrap_objid[start : start + 2])


def _across(compiled: CompiledRobot) -> int:
    """Return the coordinate along the counterbalance's joint, in which its anchors must agree."""
    balance = compiled.robot.figures.counterbalance
    assert balance
    return int(np.argmax(np.abs(compiled.model.joint(balance.joint).axis)))
