"""The instruments around a robot, as its figures state them: noise, steps of readings, errors of which one is drawn."""

from pydantic import Field

from bench.record.possible import MAX_NOISE
from bench.record.strict import Strict
from bench.robot.bounds import (
    GAIN,
    LEAST_M2,
    M2,
    RAD,
    TURN,
    M,
    Noise,
    NonNegative,
    Place,
    Positive,
    S,
    Torque,
    TorqueNoise,
)
from bench.robot.one_or_each import OneOrEach, of_each


class Tracker(Strict):
    """Laser tracker; noise grows with the distance from where it stands."""

    position_m: tuple[Place, Place, Place] = Field(description="[m], where it stands, in the base frame")
    sigma_per_distance: Noise = Field(10e-6, le=0.1, description="[m/m], one coordinate of one reading")
    placement_sigma_m: NonNegative = Field(
        15e-6, le=M, description="[m], each time a reflector is taken off and put back"
    )
    frame_sigma_m: NonNegative = Field(
        0.1e-3, le=M, description="[m], each coordinate of its frame, one draw per set-up"
    )
    frame_sigma_rad: NonNegative = Field(
        0.2e-3, le=TURN, description="[rad], about each axis of its frame, one draw per set-up"
    )
    drift_m_per_h: NonNegative = Field(5e-6, le=M, description="[m/h], of its frame, each coordinate")


class ForceSensor(Strict):
    """Force sensor at the load point. The direction error counts only where the load does not hang."""

    sigma_n: Noise = Field(0.5, le=MAX_NOISE["n"], description="[N], noise of one reading of a force")
    sigma_nm: Noise = Field(0.2, le=MAX_NOISE["nm"], description="[Nm], noise of one reading of a moment")
    gain_sigma: NonNegative = Field(0.005, le=GAIN, description="relative gain error of the reading, one draw")
    direction_sigma_rad: NonNegative = Field(
        0.005, le=RAD, description="[rad], of the direction of a load that does not hang"
    )


class CurrentSensor(Strict):
    """Motor current as the drive reports it."""

    sigma_a: Noise = Field(0.02, le=MAX_NOISE["a"], description="[A], noise of one reading")
    resolution_a: NonNegative = Field(0.01, le=MAX_NOISE["a"], description="[A], step of the reading")
    offset_sigma_a: NonNegative = Field(
        0.01, le=MAX_NOISE["a"], description="[A], offset of the reading, one draw per drive"
    )
    gain_sigma: NonNegative = Field(
        0.005, le=GAIN, description="relative gain error of the reading, one draw per drive"
    )


class TorqueSensor(Strict):
    """Motor torque as a drive reports it, reflected to the joint; of a slide a force, in N for Nm."""

    sigma_nm: OneOrEach[TorqueNoise] = Field(
        description="[Nm], noise of one reading; one for all drives, or one for each"
    )
    resolution_nm: NonNegative = Field(0.0, le=MAX_NOISE["nm"], description="[Nm], step of the reading")
    offset_sigma_nm: OneOrEach[Torque] = Field(
        0.0, description="[Nm], offset of the reading, one draw per drive; one sigma for all drives, or one for each"
    )
    gain_sigma: NonNegative = Field(0.02, le=GAIN, description="relative gain error of the reading, one draw per drive")

    def sigma_of(self, n: int) -> tuple[float, ...]:
        """Return `sigma_nm` of each of n drives [Nm]."""
        return tuple(of_each(self.sigma_nm, n).tolist())

    def offset_sigma_of(self, n: int) -> tuple[float, ...]:
        """Return `offset_sigma_nm` of each of n drives [Nm]."""
        return tuple(of_each(self.offset_sigma_nm, n).tolist())


class Encoder(Strict):
    """Motor encoder, reflected to the joint; of a slide in m for rad."""

    resolution_rad: Noise = Field(2e-7, le=RAD, description="[rad], step of the reading, at the joint")
    offset_sigma_rad: NonNegative = Field(0.0, le=TURN, description="[rad], of its zero, one draw per drive")
    zeroing_sigma_rad: NonNegative = Field(
        0.0,
        le=TURN,
        description="[rad], of the part of its zero that is another one in each recording: drives homed anew",
    )
    delay_s: NonNegative = Field(0.0, le=S, description="[s], by which it reads late")


class LinkEncoder(Strict):
    """Secondary encoders behind the gear, on some joints; of a slide in m for rad."""

    joints: tuple[str, ...] = Field(min_length=1, description="link-side joints that have one, by their names")
    resolution_rad: Noise = Field(default=2e-7, le=RAD, description="[rad], step of the reading")
    offset_sigma_rad: NonNegative = Field(default=0.0, le=TURN, description="[rad], of its zero, one draw per joint")
    zeroing_sigma_rad: NonNegative | None = Field(
        default=None,
        le=TURN,
        description="[rad], of the part of its zero that is another one in each recording",
    )
    accuracy_rad: NonNegative = Field(
        0.0, le=RAD, description="[rad], error within a turn: graduation, centring; no mean lessens it"
    )


class PressureGauge(Strict):
    """Gauge of the gas pressure in the counterbalance."""

    resolution_pa: Noise = Field(1e5, le=MAX_NOISE["pa"], description="[Pa], step of the reading")
    piston_area_m2: Positive = Field(ge=LEAST_M2, le=M2, description="[m^2], on which the gas acts")


class Instruments(Strict):
    """The nominal instruments around the robot. None: not there."""

    tracker: Tracker | None = None
    force: ForceSensor | None = None
    current: CurrentSensor | None = None
    torque: TorqueSensor | None = None
    encoder: Encoder | None = None
    link_encoder: LinkEncoder | None = None
    pressure: PressureGauge | None = None
