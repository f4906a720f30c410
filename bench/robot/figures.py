"""The figures of a robot that an MJCF has no place for: drives, ratings, instruments. One YAML file per robot."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]


class Strict(BaseModel):
    """Unknown keys are errors, values do not change after construction."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Drive(Strict):
    """One joint of the arm with its motor, gear and elastic element, by their names in the MJCF."""

    joint: str = Field(description="link-side joint (theta)")
    rotor: str = Field(description="rotor joint reflected to the joint (q); its armature is J_m N^2")
    element: str = Field(description="fixed tendon q - theta; its stiffness is k")
    servo: str = Field(description="actuator on the rotor; its force is the motor torque reflected to the joint")
    motor_friction: str = Field(description="friction actuator on the rotor joint")
    link_friction: str = Field(description="friction actuator on the link-side joint")
    torque_constant_nm_per_a: Positive = Field(description="xi = tau_motor / I, at the joint (Table 2)")
    torque_constant_error: NonNegative = Field(0.01, description="relative standard deviation of xi as known")
    speed_limit_rad_per_s: Positive


class Counterbalance(Strict):
    """A gas cylinder between two links, by its names in the MJCF. Geometry and gas figures stand in the MJCF."""

    joint: str
    tendon: str
    actuator: str


class Rating(Strict):
    """Largest load at the load point."""

    force_n: Positive
    moment_nm: Positive


class Tracker(Strict):
    """Laser tracker; noise grows with the distance from where it stands."""

    position_m: tuple[float, float, float]
    sigma_per_distance: Positive = Field(10e-6, description="[m/m], one coordinate of one reading")
    placement_sigma_m: NonNegative = Field(15e-6, description="[m], each time a reflector is taken off and put back")
    frame_sigma_m: NonNegative = 0.1e-3
    frame_sigma_rad: NonNegative = 0.2e-3
    drift_m_per_h: NonNegative = 5e-6


class ForceSensor(Strict):
    """Force sensor at the load point. The direction error counts only where the load does not hang."""

    sigma_n: Positive = 0.5
    sigma_nm: Positive = 0.2
    gain_sigma: NonNegative = 0.005
    direction_sigma_rad: NonNegative = 0.005


class CurrentSensor(Strict):
    """Motor current as the drive reports it."""

    sigma_a: Positive = 0.02
    resolution_a: NonNegative = 0.01
    offset_sigma_a: NonNegative = 0.01
    gain_sigma: NonNegative = Field(0.005, description="relative gain error of the reading, one draw per drive")


class Encoder(Strict):
    """Motor encoder, reflected to the joint."""

    resolution_rad: Positive = 2e-7
    offset_sigma_rad: NonNegative = 0.0
    delay_s: NonNegative = 0.0


class PressureGauge(Strict):
    """Gauge of the gas pressure in the counterbalance."""

    resolution_pa: Positive = 1e5
    piston_area_m2: Positive


class Instruments(Strict):
    """The nominal instruments around the robot. None: not there."""

    tracker: Tracker | None
    force: ForceSensor | None
    current: CurrentSensor | None
    encoder: Encoder | None
    pressure: PressureGauge | None = None


class Figures(Strict):
    """`figures.yaml` of a robot folder."""

    title: str
    mjcf: str = Field(description="file with the robot alone, beside this one")
    scene: str | None = None
    drives: tuple[Drive, ...] = Field(min_length=1)
    load_body: str = Field(description="massless body at the load point; wrenches are applied there")
    load_point: str = Field(description="site at the load point")
    reflectors: tuple[str, ...] = Field(min_length=1, description="sites; the first is the reference point")
    counterbalance: Counterbalance | None = None
    rating: Rating
    instruments: Instruments
