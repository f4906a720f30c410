"""What measured campaigns say of a machine and an MJCF has no place for: the section `fitted` of `figures.yaml`.

`bench diagnose` writes it into the robot folder that it hands over; it may be written by hand as well. Errors are
reading less truth, relative ones a share of the truth.
"""

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from bench.errors import unknown_name
from bench.record.strict import Strict

Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)
MOST_WEIGHT = 100.0  # grams written down for kilograms would make a thousand
# Within what a reading may err: a gain keeps its sign, and units are not what an instrument errs by
Gain = Annotated[float, Field(gt=-1, le=10)]
Offset = Annotated[float, Field(ge=-1e4, le=1e4)]
OffsetTorque = Annotated[float, Field(ge=-1e6, le=1e6)]
Turn = Annotated[float, Field(ge=-7, le=7)]
Near = Annotated[float, Field(ge=-10, le=10)]
Away = Annotated[float, Field(ge=-1e3, le=1e3)]
MAX_KELVIN = 500.0


class FittedReadings(Strict):
    """Systematic errors of the instruments, which every reading of this machine has. Zero unless given."""

    current_gain: dict[str, Gain] = Field({}, description="relative, by joint; of the reading, not of the constant")
    current_offset_a: dict[str, Offset] = Field({}, description="[A], by joint")
    torque_gain: dict[str, Gain] = Field({}, description="relative, by joint")
    torque_offset_nm: dict[str, OffsetTorque] = Field({}, description="[Nm], of a slide [N], by joint")
    link_encoder_zero_rad: dict[str, Turn] = Field({}, description="[rad], of a slide [m], by joint")
    tracker_shift_m: tuple[Away, Away, Away] = ZERO
    tracker_turn_rad: tuple[Turn, Turn, Turn] = ZERO
    tracker_drift_m_per_h: tuple[Away, Away, Away] = ZERO
    nest_m: dict[str, tuple[Near, Near, Near]] = Field(
        {}, description="[m], where a reflector sits in its nest, by site, in the axes of its body"
    )
    force_gain: Gain = 0.0
    force_tilt_rad: tuple[Turn, Turn, Turn] = Field(ZERO, description="[rad], counts only where the load does not hang")
    gas_thermometer_k: float = Field(0.0, ge=-MAX_KELVIN, le=MAX_KELVIN)


class FittedWeights(Strict):
    """By how much what hangs at the load point, and what is bolted to it, is heavier than written down; relative.

    Loads that are pulled aside may be larger beside that, and turned.

    Above -1, where there would be no weight.
    """

    hung: float = Field(0.0, gt=-1, le=MOST_WEIGHT)
    bolted: float = Field(0.0, gt=-1, le=MOST_WEIGHT)
    pulled: float = Field(0.0, gt=-1, le=MOST_WEIGHT)
    pull_turn_rad: tuple[Turn, Turn, Turn] = Field(ZERO, description="[rad], about the world's axes")


NO_READINGS, NO_WEIGHTS = FittedReadings.model_validate({}), FittedWeights.model_validate({})


class FittedEffect(Strict):
    """An effect of the catalogue, or a learned one, that acts at a place and is not in the MJCF."""

    effect: str = Field(description="name, as `bench effects` lists it, or of a learned effect")
    place: str = Field("robot", description="a driven joint, a body of the MJCF, or robot")
    values: dict[str, float] = Field(description="parameter -> value, SI units")
    form: dict[str, str | int | float | tuple[float, ...]] = Field(
        {}, description="of a learned effect: what its shape rests on"
    )


class Fitted(Strict):
    """`fitted` of `figures.yaml`."""

    readings: FittedReadings = NO_READINGS
    weights: FittedWeights = NO_WEIGHTS
    effects: tuple[FittedEffect, ...] = ()
    unfinished: str = Field("", description="why its diagnosis ended before it was done; else empty")
    recording: str = Field("", description="of several that were fitted, the one whose payload and zeros it has")

    def __hash__(self) -> int:
        """Return a hash although dictionaries have none: robots are keys of what is kept in memory."""
        return hash(self.model_dump_json())

    @property
    def is_given(self) -> bool:
        """Whether anything stands in it."""
        return self.model_copy(update={"unfinished": "", "recording": ""}) != NOTHING

    def words(self) -> Iterator[str]:
        """Yield what stands in it, for people."""
        for name in (*self.readings.model_dump(exclude_defaults=True), *self.weights.model_dump(exclude_defaults=True)):
            yield name.replace("_", " ")
        yield from (f"{one.effect} ({one.place})" for one in self.effects)

    def faults(self, joints: list[str], reflectors: tuple[str, ...]) -> Iterator[str]:
        """Yield a sentence for every joint or reflector that the robot does not have."""
        by_joint = ("current_gain", "current_offset_a", "torque_gain", "torque_offset_nm", "link_encoder_zero_rad")
        for field, known, what in (
            *((field, joints, "driven joint") for field in by_joint),
            ("nest_m", list(reflectors), "reflector"),
        ):
            for name in getattr(self.readings, field):
                if name not in known:
                    yield f"fitted.readings.{field}: {unknown_name(what, name, known)}"


NOTHING = Fitted.model_validate({})
