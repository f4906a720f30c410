"""The figures of a robot that an MJCF has no place for: drives, ratings, instruments. One YAML file per robot."""

import re
from typing import Self

from pydantic import Field, model_validator

from bench.errors import unknown_name
from bench.record.strict import Strict
from bench.robot.bounds import (
    GAIN,
    KG,
    LEAST_NM_PER_A,
    NM,
    NM_PER_A,
    RAD_PER_S,
    RATIO,
    SHARE,
    TURN,
    M,
    N,
    NonNegative,
    OneLine,
    Positive,
    Share,
)
from bench.robot.drive_uncertainty import DriveUncertainty
from bench.robot.fitted import NOTHING, Fitted
from bench.robot.instruments import Instruments
from bench.robot.one_or_each import OneOrEach, of_each, wrong_lengths


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

    @property
    def by_number(self) -> str:
        """Return which joint has which number, "joint 1 is rail, 2 a1"; "" where names end with their own numbers."""
        names = [drive.joint for drive in self.drives]
        if all(re.search(rf"(?<!\d)0*{i}$", name) for i, name in enumerate(names, start=1)):
            return ""
        return "joint " + ", ".join(f"{i}{' is' * (i == 1)} {name}" for i, name in enumerate(names, start=1))

    @property
    def titled(self) -> str:
        """Return the title, with the numbers that reports have for joints of other names."""
        return f"{self.title} ({self.by_number})" if self.by_number else self.title

    def assumes(self, figure: str, joint: str) -> bool:
        """Return whether a figure of a joint, such as "speed limit", is a guess that `assumed` still lists."""
        listed = re.compile(rf"{re.escape(figure)} \((?:.*, )?{re.escape(joint)} [^ ,)]+[,)]")
        return any(listed.match(line) for line in self.assumed)
