"""The figures of a robot that an MJCF has no place for: drives, ratings, instruments. One YAML file per robot."""

import re
from typing import Annotated, Self

from pydantic import Field, model_validator

from bench.errors import unknown_name
from bench.record.possible import MAX_NOISE, MIN_NOISE
from bench.record.schema_words import ONE_LINE
from bench.record.strict import Strict
from bench.robot.drive_uncertainty import DriveUncertainty
from bench.robot.fitted import NOTHING, Fitted
from bench.robot.one_or_each import OneOrEach, of_each, wrong_lengths

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
# Most that a figure of a robot or of its instruments can be: far above real ones, and below what a slip of the keyboard
# or of a unit makes of them. Of a slide rad stands for m, Nm for N
SHARE = 100.0  # relative standard deviation of a figure of the model
GAIN = 10.0  # relative standard deviation of a gain, an instrument's or a torque constant's
RAD = 1.0
TURN = 7.0  # [rad], of a zero or a frame of which nobody knows where it points
M = 10.0
LEAST_M2, M2 = 1e-7, 10.0  # a piston of 0.4 mm
RAD_PER_S = 1e3
S = 10.0
N = NM = 1e7
KG = 1e5
LEAST_NM_PER_A = 1e-6  # motors of a gram make a thousand times more
NM_PER_A = RATIO = 1e6
AWAY = 1e3  # [m], of an instrument from the robot; laser trackers see 160 m far
# Of one reading; noise and steps of instruments, as of campaigns (`bench.record.possible`)
Noise = Annotated[float, Field(ge=MIN_NOISE)]
TorqueNoise = Annotated[float, Field(ge=MIN_NOISE, le=MAX_NOISE["nm"])]
Torque = Annotated[float, Field(ge=0, le=MAX_NOISE["nm"])]
Share = Annotated[float, Field(ge=0, le=SHARE)]
OneLine = Annotated[str, Field(pattern=ONE_LINE)]  # it is printed, and stands in pages
Place = Annotated[float, Field(ge=-AWAY, le=AWAY)]


class Drive(Strict):
    """One joint of the arm with its motor, gear and elastic element, by their names in the MJCF."""

    joint: str = Field(description="link-side joint (theta)")
    rotor: str = Field(description="rotor joint reflected to the joint (q); its armature is J_m N^2")
    element: str = Field(description="fixed tendon q - theta; its stiffness is k")
    servo: str = Field(description="actuator on the rotor; its force is the motor torque reflected to the joint")
    motor_friction: str = Field(description="friction actuator on the rotor joint")
    link_friction: str = Field(description="friction actuator on the link-side joint")
    torque_constant_nm_per_a: Positive = Field(
        1.0,
        ge=LEAST_NM_PER_A,
        le=NM_PER_A,
        description="xi = tau_motor / I, at the joint (Table 2); left out where the drive reports torque",
    )
    torque_constant_error: NonNegative = Field(0.01, le=GAIN, description="relative standard deviation of xi as known")
    gear_ratio: Positive | None = Field(
        None,
        le=RATIO,
        description="turns of the motor to one of the joint; for logs with angles of the motors, of hinges alone",
    )
    speed_limit_rad_per_s: Positive = Field(le=RAD_PER_S, description="at the joint; of a slide [m/s]")

    @property
    def states_torque_constant(self) -> bool:
        """Whether the torque constant was written down; else the drive reports torque."""
        return "torque_constant_nm_per_a" in self.model_fields_set


class Counterbalance(Strict):
    """A gas cylinder between two links, by its names in the MJCF. Geometry and gas figures stand in the MJCF."""

    joint: str
    tendon: str
    actuator: str


MOST_RATINGS = 100.0  # times the rating, that no robot carries; grams for kilograms make a thousand


class Rating(Strict):
    """Largest load at the load point."""

    force_n: Positive = Field(le=N)
    moment_nm: Positive = Field(le=NM)


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


class Uncertainty(Strict):
    """How well the nominal model is known: standard deviations of what may be wrong everywhere, a little.

    What such errors can explain is never called a discovery. The friction, mass and geometry figures are those of a
    well-kept model of a heavy arm; a model taken from a drawing deserves larger ones.
    """

    mass: NonNegative = Field(0.01, le=SHARE, description="relative, of each link")
    centre_of_mass_m: NonNegative = Field(1e-3, le=M, description="[m], each coordinate, of each link")
    links: float = Field(
        1.0,
        ge=1,
        le=SHARE,
        description="times that these two are larger; above 1, moments of inertia of links are as unknown",
    )
    geometry_m: NonNegative = Field(
        0.2e-3, le=M, description="[m], each coordinate of each joint's place and of the anchors"
    )
    axis_rad: NonNegative = Field(
        0.0,
        le=TURN,
        description="[rad], each of two leans of each joint's axis across its direction; real arms: 3e-4 to 1e-3",
    )
    friction: OneOrEach[Share] = Field(
        0.05,
        description="relative, of each Coulomb level and each viscous coefficient; one for all drives, or one for each",
    )
    presliding: NonNegative = Field(
        2.0, le=SHARE, description="relative, of how stiff each friction element holds; 2: known to a factor of 3"
    )
    rotor_inertia: OneOrEach[Share] = Field(
        0.1, description="relative, of each rotor with its gear; one for all drives, or one for each"
    )
    stiffness: OneOrEach[Share] = Field(
        0.03,
        description="relative, of each elastic element; 3: known to a factor of 4; one for all drives, or one for each",
    )
    gas_constant: NonNegative = Field(0.01, le=SHARE, description="relative, of the counterbalance's C")
    critical_length_m: NonNegative = Field(0.5e-3, le=M, description="[m], of the counterbalance's l_c")
    load: NonNegative = Field(0.001, le=SHARE, description="relative, of weights hung or bolted on")
    pull: NonNegative = Field(
        0.0, le=SHARE, description="relative, of loads pulled aside (load cell, pulley), beside `load`; anew each time"
    )
    pull_rad: NonNegative = Field(
        0.0, le=1, description="[rad], about each axis, of the direction of loads pulled aside; anew each time"
    )
    payload_kg: NonNegative | None = Field(
        None, le=KG, description="[kg], largest payload that recordings may leave unstated; by default the rated load"
    )

    def of_drives(self, n: int) -> DriveUncertainty:
        """Return what is stated of the drives, for each of n."""
        return DriveUncertainty(
            friction=of_each(self.friction, n),
            rotor_inertia=of_each(self.rotor_inertia, n),
            stiffness=of_each(self.stiffness, n),
        )


class Figures(Strict):
    """`figures.yaml` of a robot folder."""

    title: OneLine
    mjcf: str = Field(description="file with the robot alone, beside this one")
    scene: str | None = None
    drives: tuple[Drive, ...] = Field(min_length=1)
    load_body: str = Field(description="massless body at the load point; wrenches are applied there")
    load_point: str = Field(description="site at the load point")
    reflectors: tuple[str, ...] = Field((), description="sites; the first is the reference point")
    counterbalance: Counterbalance | None = None
    rating: Rating
    instruments: Instruments
    uncertainty: Uncertainty = Uncertainty.model_validate({})
    fitted: Fitted = NOTHING
    assumed: tuple[OneLine, ...] = Field(
        (), description="what nobody knows of this robot yet, and what was taken in its place; `bench check` shows it"
    )

    @model_validator(mode="after")
    def _instruments_have_something_to_measure(self) -> Self:
        """Refuse instruments that are named without what they measure."""
        fitted = self.instruments
        if fitted.tracker and not self.reflectors:
            raise ValueError("instruments.tracker needs reflectors: name a site of the MJCF, or write tracker: null")
        if fitted.pressure and not self.counterbalance:
            raise ValueError("instruments.pressure needs a counterbalance: name it, or write pressure: null")
        if twice := {name for name in self.reflectors if self.reflectors.count(name) > 1}:
            raise ValueError(f"reflectors: {', '.join(sorted(twice))} named twice; name each once")
        joints = [drive.joint for drive in self.drives]
        unstated = [drive.joint for drive in self.drives if not drive.states_torque_constant]
        if fitted.current and unstated:
            raise ValueError(
                f"drives: torque_constant_nm_per_a is missing for {', '.join(unstated)}, and instruments.current says "
                "that drives report current: write how many Nm at the joint one A makes (motor constant times gear "
                "ratio); where nobody knows, write current: null, then `bench convert --look LOG --robot DIR` tells it"
            )
        torque = {f"instruments.torque.{name}": value for name, value in fitted.torque or ()}
        known = {f"uncertainty.{name}": value for name, value in self.uncertainty}
        if faults := tuple(wrong_lengths(torque | known, len(joints))):
            raise ValueError("; ".join(faults))
        for name in fitted.link_encoder.joints if fitted.link_encoder else ():
            if name not in joints:
                raise ValueError(f"instruments.link_encoder.joints: {unknown_name('driven joint', name, joints)}")
        if faults := tuple(self.fitted.faults(joints, self.reflectors)):
            raise ValueError(" ".join(faults))
        return self

    @property
    def drive_uncertainty(self) -> DriveUncertainty:
        """How well the figures of each drive are known."""
        return self.uncertainty.of_drives(len(self.drives))

    def assumes(self, figure: str, joint: str) -> bool:
        """Return whether a figure of a joint, such as "speed limit", is a guess that `assumed` still lists."""
        listed = re.compile(rf"{re.escape(figure)} \((?:.*, )?{re.escape(joint)} [^ ,)]+[,)]")
        return any(listed.match(line) for line in self.assumed)
