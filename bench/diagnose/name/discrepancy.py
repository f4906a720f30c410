"""Learn: the free shape of an unlisted cause becomes an effect, fitted by simulation beside what is listed."""

from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.cross_validation.held_out import NOTICEABLE, held_out
from bench.diagnose.cross_validation.jackknife import with_jackknife
from bench.diagnose.extend.fit import Fit, Key, pseudo_residual
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.generic import Block, anew
from bench.diagnose.linearise.lack_of_fit import are_settled, factors_of, left_by_nuisances, missed, unexplained
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Columns, Nuisances
from bench.diagnose.linearise.other_noise import raised, roughened, with_play
from bench.diagnose.linearise.screening import WIDTHS
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.naming import Naming
from bench.diagnose.name.search_space import GREATER_PART
from bench.effects.effect import WHOLE, Effect, Place
from bench.effects.friction_elements import Side
from bench.effects.learned import Learned, values_at, values_of
from bench.effects.learned_readings import (
    IN_ROOM,
    IN_TIME,
    OF_READING,
    UNDER_FORCE,
    LearnedDrift,
    LearnedLoss,
    LearnedMount,
    LearnedRoom,
    LearnedScale,
    LearnedStick,
)
from bench.effects.learned_torques import (
    LearnedCompliance,
    LearnedDrag,
    LearnedFriction,
    LearnedGearError,
    LearnedTorque,
    LearnedTorsion,
)
from bench.errors import NOT_SIMULATED
from bench.record.campaign import Array
from bench.robot.counterbalance import Counterbalance

OVER = {"angle": "rad", "angle and direction": "rad", "speed": "rad/s", "load": "Nm"}
ANGLE_NODES = (9, 17, 33)  # effort: tried over an angle; each has those of the one before
ROUNDS = 3  # effort: fits in turn, each with the standard errors that the one before asks for
NOT_THERE = "nothing in the simulator can act so: the shape is known, but no model runs with it"
NO_BALANCE = "a model with it finds no balance along the measured motion"
FALLS_SHORT = "a model with it runs, but cannot do what the data ask for (friction never drives), and is not written"
ROUGH = "once rough readings count as noise, too little of it is left for a model to learn"
REFUSED = "a model with it runs, but does not predict the data better that it was not fitted to, and is not written"
IN_MODEL = "the extended model has it"
IN_READINGS = "it runs as an error of readings, outside of the model"


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """What became of a free shape.

    Attributes:
        linear: The campaign with the standard errors that count beside the shape.
        fit: The model with it, and what is listed beside it; None where it cannot run.
        is_gain: Whether the data are more probable with the shape than without it, fitted and held out alike.
        words: The same for people.
    """

    linear: LinearisedModel
    fit: Fit | None
    is_gain: bool
    words: str

    @property
    def cause(self) -> Cause | None:
        """The shape as a cause, the last one of the fit."""
        return self.fit.causes[-1] if self.fit else None


def discrepancy_of(naming: Naming) -> Discrepancy | None:
    """Return what becomes of the free shape that a naming calls unlisted; None where it calls none so."""
    if naming.unlisted is None:
        return None
    return learn(naming.linear, naming.unlisted, naming.models[0].listed_fit(naming.linear))


def learn(linear: LinearisedModel, block: Block, beside: Fit) -> Discrepancy:
    """Fit a free shape by simulation, together with all causes beside it, from what the linearised model says of it.

    The linearised model chooses the distance of nodes over an angle and the width of the prior, by evidence. Standard
    errors that a poor model raised fall to what the better one leaves, and the shape is fitted anew.

    Args:
        linear: The campaign, in which the block was found.
        block: The free shape.
        beside: What the model has already.
    """
    linear = with_play(beside.design(linear), beside.play)
    # where a shape changes within a bin, no table can follow: what is rough by the instruments' errors is noise
    plain = roughened(raised(linear, 1 / linear.inflation), beside.residual)
    linear = raised(plain, np.maximum(missed(plain, left_by_nuisances(plain, pseudo_residual(plain, beside))), 1.0))
    for left in reversed(range(ROUNDS)):
        estimate = _best(linear, block, beside)
        effect = effect_of(linear, estimate.block)
        if effect is None:
            return Discrepancy(linear, None, False, NOT_THERE)
        try:
            fit = refit(linear, *_start(effect, place_of(linear, block), estimate, beside))
            without = refit(linear, beside.causes, beside.start, beside.nuisances)
        except NOT_SIMULATED:
            return Discrepancy(linear, None, False, NO_BALANCE)
        gained = fit.log_evidence - without.log_evidence
        if estimate.log_evidence < LEAST:
            return Discrepancy(linear, fit, False, ROUGH)
        if gained < GREATER_PART * estimate.log_evidence:
            return Discrepancy(linear, fit, False, FALLS_SHORT)
        factors = _factors(linear, block, fit)
        if not left or are_settled(factors):
            break
        linear = raised(linear, factors)
    gain = held_out(linear, without, fit)
    if gained <= 0 or not gain.predicts_better(NOTICEABLE):
        return Discrepancy(linear, fit, False, REFUSED)
    is_in_model = type(fit.causes[-1].effect).edit is not Effect.edit
    return Discrepancy(linear, with_jackknife(linear, fit), True, IN_MODEL if is_in_model else IN_READINGS)


def _factors(linear: LinearisedModel, block: Block, fit: Fit) -> Array:
    """Return by what standard errors change beside a learned shape, shape (2, c); its finest form is the richest."""
    plain = raised(linear, 1 / linear.inflation)
    finest = anew(plain, block, ANGLE_NODES[-1])
    prior = np.full(finest.columns.shape[1], finest.prior)
    least = np.maximum(unexplained(plain, pseudo_residual(plain, fit), Columns(finest.columns), prior), 1.0)
    return factors_of(linear, linear.whiten(fit.residual), least)


@dataclass(frozen=True, eq=False)
class _Estimate:
    """A block in the linearised model; k coefficients.

    Attributes:
        block: The free shape.
        value: Shape (k,).
        shift: Of the unknowns of the model beside it, whose part the shape may take over.
        log_evidence: Against the model beside it.
    """

    block: Block
    value: Array
    shift: Array
    log_evidence: float


def _best(linear: LinearisedModel, block: Block, beside: Fit) -> _Estimate:
    """Return a block with the nodes and the prior for which there is most evidence beside a fit."""
    white, tangent = pseudo_residual(linear, beside), linear.whiten(beside.jacobian)
    nuisances, sigma = Nuisances(linear.jacobian), np.array([unknown.sigma for unknown in beside.unknowns])
    found = []
    for count in ANGLE_NODES if block.depends_on in ("angle", "angle and direction") else ANGLE_NODES[:1]:
        tried = anew(linear, block, count)
        k = tried.columns.shape[1]
        every: Array = np.arange(k + tangent.shape[1])
        products = nuisances.products(white, np.concatenate([tried.columns, tangent], axis=1))
        marginal = products.given(every[k:], sigma)
        for width in WIDTHS:
            wide = replace(tried, prior=width * tried.prior)
            prior = np.full(k, wide.prior)
            value, _ = products.sizes(every, np.concatenate([prior, sigma]))
            found.append(_Estimate(wide, value[:k], value[k:], marginal.log_evidence(every[:k], prior)))
    return max(found, key=lambda one: one.log_evidence)


def _start(
    effect: Learned, place: Place, estimate: _Estimate, beside: Fit
) -> tuple[tuple[Cause, ...], dict[Key, float], Array | None]:
    """Return causes, first values and nuisances of a fit with an effect beside another fit."""
    cause = Cause(effect, place, effect.parameters, ())
    values = estimate.value
    if isinstance(effect, LearnedDrag):
        values = np.interp(effect.nodes, estimate.block.nodes, values)
    start = {
        (*cause.key, parameter.name): float(value) for parameter, value in zip(effect.parameters, values, strict=True)
    }
    for unknown, before, shift in zip(beside.unknowns, beside.values, estimate.shift, strict=True):
        if not unknown.parameter.is_shape:
            start[unknown.key] = float(before + shift)
    # the nominal model's figures are bent by what is missing: no place to start from
    return (*beside.causes, cause), beside.start | start, beside.nuisances if beside.causes else None


def place_of(linear: LinearisedModel, block: Block) -> Place:
    """Return where a block acts."""
    if block.drive < 0:
        return WHOLE
    return Place("joint", block.drive, linear.replay.compiled.robot.figures.drives[block.drive].joint)


def effect_of(linear: LinearisedModel, block: Block) -> Learned | None:
    """Return a free shape as an effect; None where nothing in the simulator can act so.

    A friction of the link that depends on the load in any way is such a thing; on the motor's side it is a reading.
    """
    compiled = linear.replay.compiled
    if block.kind == "reading":
        return _of_reading(block, compiled.counterbalance)
    over, unit = OVER[block.depends_on], block.unit
    if compiled.is_slide[block.drive]:
        over, unit = (words.replace("rad", "m").replace("Nm", "N") for words in (over, unit))
    nodes = LearnedDrag.speeds(block.nodes) if block.depends_on == "speed" else block.nodes
    if len(nodes) < (1 if block.depends_on == "speed" else 2):
        return None
    values = values_at(nodes, over, unit, block.prior)
    side: Side = "link" if block.kind == "link torque" else "motor"
    match block.kind, block.depends_on:
        case "compliance", "angle":
            return LearnedCompliance(values, nodes)
        case "gear angle", "angle":
            return LearnedGearError(values, nodes)
        case "gear angle", "load":
            return LearnedTorsion(values, nodes)
        case "motor torque", "load":
            j = block.drive
            return LearnedLoss(values, nodes, float(compiled.stiffness[j]), float(compiled.torque_constant[j]))
        case _, "angle":
            return LearnedTorque(values, nodes, side)
        case _, "angle and direction":
            return LearnedFriction(values, nodes, side)
        case _, "speed":
            return LearnedDrag(values, nodes, side)
    return None


def _of_reading(block: Block, counterbalance: Counterbalance | None) -> Learned:
    if counterbalance and block.depends_on == "angle and direction":
        stuck = values_at(block.nodes, OVER[block.depends_on], block.unit, block.prior)
        return LearnedStick(stuck, block.nodes, counterbalance.joint)
    known = {"load": OF_READING, "place": IN_ROOM, "time": IN_TIME, "force": UNDER_FORCE}[block.depends_on]
    names = [known[i] for i in block.functions]
    values = values_of(names, [name.replace("_", " ") for name in names], block.unit, block.prior)
    if block.depends_on == "load":
        return LearnedScale(values, "current" if block.unit == "A" else "torque", block.size)
    if block.depends_on == "place":
        return LearnedRoom(values, block.origin, block.size)
    if block.depends_on == "force":
        return LearnedMount(values, block.reflector, block.size)
    return LearnedDrift(values, float(block.origin[0]))
