"""What an earlier diagnosis left, as the prior of this one.

Its robot is the nominal one. What its data said of figures and findings, all correlations included, are further
readings: combinations of deviations that are 0 with a standard deviation of 1. Together with the stated uncertainty
they are the posterior of the earlier diagnosis, so two diagnoses in a row know what one of both campaigns would know.

What was found and is another one in each recording, as a payload is, is integrated out.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.replay.nuisances import Earlier, Nuisance
from bench.diagnose.replay.posterior import Posterior as Posterior  # what is given
from bench.diagnose.replay.posterior import PosteriorParameter as PosteriorParameter  # what is given
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.drifts import COULOMB, DAY_K, VISCOUS
from bench.effects.effect import Acting, Effect, Place
from bench.effects.fitted import acting_of
from bench.errors import NOT_SIMULATED, RobotError
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_spec, read_spec
from bench.robot.fitted import FittedEffect

EARLIER = Quantity("known_earlier_1", "known_earlier", "1")
LABEL = "earlier diagnosis"
REACH = 2.0  # declared: standard deviations of a finding, as far as which it has to make a model
# rounding: of the information that is stated; what the earlier campaign says less about, it says nothing of
UNTOLD = 1e-6
# Friction that a diagnosis finds where the nominal model has none -> the figure that is all of it from then on, and how
# far that drifts.
DRIFTS = {
    "coulomb_friction": ("motor-side Coulomb friction", COULOMB * DAY_K),
    "viscous_friction": ("viscous friction", VISCOUS * DAY_K),
    "rolling_friction": ("rolling friction", VISCOUS * DAY_K),
}
LEAST = 0.05  # rounding: of what was stated, to which a torque constant or a change may have shrunk


@dataclass(frozen=True, eq=False)
class Given:
    """A posterior about the robot that was handed over with it.

    Attributes:
        nuisances: What may be off, with what the earlier diagnosis says of each.
        figures: Names of figures that it knows.
        findings: Names of findings that may be off a little.
        held: Names of findings that are taken as they were found: nothing but their values is in the model.
        anew: Names of findings that belonged to the earlier recording, of which nothing is known in this one.
    """

    nuisances: tuple[Nuisance, ...]
    figures: tuple[str, ...]
    findings: tuple[str, ...]
    held: tuple[str, ...]
    anew: tuple[str, ...] = ()


def given_by(posterior: Posterior, nuisances: Sequence[Nuisance], compiled: CompiledRobot) -> Given:
    """Return the figures of a robot that a diagnosis handed over, with what that diagnosis knew of them.

    Args:
        posterior: Of the diagnosis.
        nuisances: Of the robot, as stated.
        compiled: It.
    """
    own = {(one.name, one.unit): i for i, one in enumerate(nuisances)}
    # the robot has the day of the only recording, or nearly what lasts: the mean of several (`levels.py: handed_over`)
    days = 1 if compiled.robot.figures.fitted.recording else 2
    found, which, at, held, anew = _of_found_friction(posterior, nuisances, days), [], [], [], []
    for i, one in enumerate(posterior.parameters):
        if not one.effect:
            mine = own.get((one.name, one.unit))
            if mine is None or found[mine].earlier:
                continue
            if nuisances[mine].drifts_besides:
                day = float(np.sqrt(posterior.covariance[i, i])) * one.sigma
                found[mine] = _on_another_day(one, nuisances[mine], day, days)
                continue
            found[mine] = _after(one, found[mine], np.inf)
            if nuisances[mine].lasting > 0:
                which.append(i)
                at.append(mine)
            continue
        if is_anew(one):
            anew.append(one.name)
            continue
        nuisance = finding_on_top(one, REACH * float(np.sqrt(posterior.covariance[i, i])) * one.sigma, compiled)
        if nuisance is None:
            held.append(one.name)
            continue
        which.append(i)
        at.append(len(found))
        found.append(nuisance)
    if not which:
        return Given(tuple(found), (), (), tuple(held), tuple(anew))
    kept = np.array([_kept(nuisances[i]) if i < len(nuisances) else 1.0 for i in at])
    known = posterior.covariance[np.ix_(which, which)]
    expected = np.outer(kept, kept) * known + np.diag(1 - kept**2)
    rows = _rows(expected)
    for column, i in enumerate(at):
        one = posterior.parameters[which[column]]
        sigma = found[i].sigma if found[i].is_factor else sigma_about(one)
        spread = np.sqrt([known[column, column], expected[column, column]])
        after = _after(one, replace(found[i], sigma=sigma), *spread.tolist())
        found[i] = replace(after, said_before=tuple((rows[:, column] / sigma).tolist()))
    names = [found[i].name for i in at]
    n = sum(i < len(nuisances) for i in at)
    return Given(tuple(found), tuple(names[:n]), tuple(names[n:]), tuple(held), tuple(anew))


def _after(one: PosteriorParameter, nuisance: Nuisance, known: float, expected: float = 1.0) -> Nuisance:
    """Return something that may be off with what an earlier diagnosis left of it.

    Args:
        one: As the earlier diagnosis has it.
        nuisance: As it may be off in this one.
        known: As of `Earlier`, in its standard deviations.
        expected: Likewise.
    """
    off = nuisance.off_by(one.found / one.sigma) if nuisance.is_factor else one.found
    left = Earlier(one.before, known * nuisance.sigma, expected * nuisance.sigma, one.is_share)
    return replace(nuisance, earlier=replace(left, found=left.total(off)))


def _on_another_day(one: PosteriorParameter, nuisance: Nuisance, known: float, days: int) -> Nuisance:
    """Return a figure that drifts by more than is stated of it, such as friction, as the next recording may have it.

    Args:
        one: As the earlier diagnosis has it.
        nuisance: As it may be off in this one, without its drift.
        known: Standard deviation with which it was known, in its unit.
        days: By the drifts of how many it differs: of this one, and of that of the robot if it has the day of one.
    """
    sigma = float(np.sqrt(known**2 + days * nuisance.own**2))
    return replace(_after(one, nuisance, known / nuisance.sigma, sigma / nuisance.sigma), sigma=sigma)


def _of_found_friction(posterior: Posterior, nuisances: Sequence[Nuisance], days: int) -> list[Nuisance]:
    """Return what may be off, with friction that was found where nothing was stated as uncertain as days differ.

    What is stated of friction is a share of what the nominal model has, which is nothing there: the level is as well
    known as it was found, and differs by the drifts of one day or two.
    """
    found = list(nuisances)
    at = {one.name: i for i, one in enumerate(nuisances)}
    for one in posterior.parameters:
        if one.effect in DRIFTS:
            title, drift = DRIFTS[one.effect]
            if (i := at.get(f"{title} of {one.place}")) is not None:
                sigma = float(np.sqrt(days)) * drift
                found[i] = replace(nuisances[i], sigma=sigma, earlier=Earlier(0.0, 0.0, sigma, is_share=True))
    return found


def is_anew(one: PosteriorParameter) -> bool:
    """Return whether a parameter belongs to a finding that is another one in each recording, as a payload is."""
    effect = catalogue().get(one.effect)
    return effect is not None and effect.between == "anew"


def _kept(nuisance: Nuisance) -> float:
    """Return the correlation of something that may be off with itself in another recording."""
    return nuisance.lasting**2 / (nuisance.lasting**2 + nuisance.own**2)


def with_earlier(
    segments: Sequence[Segment], quantities: Sequence[Quantity], nuisances: Sequence[Nuisance]
) -> tuple[Segment, ...]:
    """Return segments with the readings of an earlier diagnosis, after the last of them, where the arm stands.

    It is no visit of a static run, whose friction at rest would have to be known.

    Args:
        segments: Of the campaign, at least one.
        quantities: With `EARLIER`, if anything is given.
        nuisances: With what the earlier diagnosis says of them, if anything is given.
    """
    k = rows_of(nuisances)
    if not k or not segments:
        return tuple(segments)
    last = segments[-1]
    mine = np.array([quantity == EARLIER for quantity in quantities])
    read = np.flatnonzero(last.motion.read)[-1:].repeat(k + 1)
    still = np.zeros((k + 1, last.motion.q.shape[1]))
    motion = replace(
        last.motion,
        time=last.motion.time[-1] + np.arange(k + 1.0),
        q=last.motion.q[read],
        velocity=still,
        acceleration=still,
        wrench=last.motion.wrench[read],
        read=np.arange(k + 1) > 0,
        begins=None,
    )
    one = Segment(
        run=last.run,
        label=LABEL,
        is_static=False,
        motion=motion,
        conditions=last.conditions,
        observed=np.tile(np.where(mine, 0.0, np.nan), (k, 1)),
        sigma=np.tile(np.where(mine, 1.0, np.nan), (k, 1)),
        standing=np.ones(still.shape[1], dtype=bool),
        acceleration_error=still[1:],
        rings=np.zeros(k, dtype=bool),
        recording=last.recording,
        is_known=True,
    )
    return (*segments, one)


def rows_of(nuisances: Iterable[Nuisance]) -> int:
    """Return how many readings an earlier diagnosis makes."""
    return max((len(nuisance.said_before) for nuisance in nuisances), default=0)


def said_before(deviations: Mapping[Nuisance, float], rows: int) -> Array:
    """Return what a world says of the readings of an earlier diagnosis, shape (rows,)."""
    said = np.zeros(rows)
    for nuisance, value in deviations.items():
        if nuisance.said_before:
            said += value * np.array(nuisance.said_before)
    return said


def sigma_about(one: PosteriorParameter) -> float:
    """Return the standard deviation of a prior about what was found; a relative deviation is one of that then."""
    return one.sigma / max(1 + one.found, LEAST) if one.is_share else one.sigma


def _rows(covariance: Array) -> Array:
    """Return what data said, shape (k, n), so that I + rows^T rows is the inverse of a posterior's covariance."""
    information = np.linalg.inv(covariance) - np.eye(len(covariance))
    power, directions = np.linalg.eigh((information + information.T) / 2)
    told = power > UNTOLD
    rows: Array = np.sqrt(power[told])[:, None] * directions[:, told].T
    return rows


def finding_on_top(one: PosteriorParameter, reach: float, compiled: CompiledRobot) -> Nuisance | None:
    """Return a finding's size as something that may be off, on top of what the model has; None where it cannot be.

    It has to make a model as far as `reach` to either side.
    """
    acting = _on_top(one, compiled)
    if acting is None:
        return None
    parameter = next(p for p in acting.effect.parameters if p.name == one.parameter)
    if parameter.quotient:  # it changes nothing without the other size
        return None

    def edit(x: float) -> SpecEdit:
        changed = acting.effect.edit(
            acting.place, {**acting.values, one.parameter: parameter.null + x}, Conditions.reference(compiled.n_joints)
        )
        return changed or (lambda spec, robot: None)

    if not _is_in_model(acting) or not all(_runs(compiled, edit(x)) for x in (-reach, reach)):
        return None
    return Nuisance(one.name, one.unit, one.sigma, edit=edit)


def _on_top(one: PosteriorParameter, compiled: CompiledRobot) -> Acting | None:
    """Return the effect of a finding as it may act once more; None where it sets what is there already."""
    joints = [drive.joint for drive in compiled.robot.figures.drives]
    effect = catalogue().get(one.effect)
    values = {one.parameter: 0.0, **one.shapes}
    if effect and effect.is_additive and one.place in joints:  # also where it is looked for only if it is not there
        return Acting(effect, Place("joint", joints.index(one.place), one.place), effect.complete(values))
    try:
        return acting_of(FittedEffect(effect=one.effect, place=one.place, values=values, form={}), compiled)
    except RobotError:
        return None


def _is_in_model(acting: Acting) -> bool:
    """Whether an effect is nothing but an edit of the model that is the same under all conditions."""
    kind = type(acting.effect)
    others = (kind.distort is Effect.distort, kind.encoder_error is Effect.encoder_error)
    return kind.edit is not Effect.edit and all(others) and not acting.effect.depends_on_conditions


def _runs(compiled: CompiledRobot, edit: SpecEdit) -> bool:
    try:
        compile_spec(read_spec(compiled.robot), compiled.robot, [edit])
    except (*NOT_SIMULATED, ValueError):
        return False
    return True
