"""The catalogue: every effect by its name, those that come with the bench and those from a user's own files."""

import importlib.util
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import ModuleType

from bench.effects.anchors import Anchor
from bench.effects.balancer import SpringBalancer
from bench.effects.effect import Effect
from bench.effects.friction import CoulombFriction, CoulombLevel, FrictionSide
from bench.effects.friction_shape import DirectionFriction, DirectionViscous, FrictionRipple, LoadFriction, Stribeck
from bench.effects.gas import (
    CounterbalanceGas,
    GasLoss,
    GasTemperature,
    PolytropicExponent,
    SealFriction,
    ThermalRelaxation,
)
from bench.effects.gear_kinematics import AxisCoupling, TransmissionError, WristCoupling
from bench.effects.geometry import DressPack, FloorTilt, JointZero, LinkLength, ThermalGrowth
from bench.effects.lubricant import (
    FrictionTemperature,
    FrictionWarming,
    RollingFriction,
    RollingLevel,
    Viscous,
    ViscousFriction,
)
from bench.effects.masses import LinkCom, LinkInertia, LinkMass, RotorInertia, TorqueOffset
from bench.effects.own import faults_of, guarded, line_in
from bench.effects.payloads import PayloadCom, PayloadMass, UnstatedPayload
from bench.effects.recording_channel import (
    ChannelDelay,
    ChannelDrift,
    ChannelOffset,
    ChannelScale,
    ChannelStep,
    TrackerCreep,
    TrackerStep,
)
from bench.effects.recording_log import BoltedLoad, HungLoad
from bench.effects.sensing_bench import ForceGain, ForceTilt, TrackerDrift, TrackerFrame, TrackerScale
from bench.effects.sensing_drive import (
    CurrentOffset,
    DriveDelay,
    EncoderDelay,
    EncoderEccentricity,
    TorqueConstant,
    TorqueConstantTemperature,
    TorqueSaturation,
)
from bench.effects.sensing_link import LinkEncoderDelay
from bench.effects.session_time import GasLeak, GasStep, JointSlip
from bench.effects.structure import BaseCompliance, BaseTorsion, BearingTilt, LinkBending
from bench.effects.transmission import Backlash, ComplianceTemperature, Hysteresis, JointCompliance, Softening
from bench.errors import InputError

BUILT_IN: tuple[type[Effect], ...] = (
    # gas and cylinder
    PolytropicExponent,
    GasLoss,
    GasLeak,
    GasStep,
    GasTemperature,
    ThermalRelaxation,
    SealFriction,
    Anchor,
    CounterbalanceGas,
    # drive friction
    CoulombLevel,
    CoulombFriction,
    Viscous,
    ViscousFriction,
    RollingFriction,
    RollingLevel,
    Stribeck,
    LoadFriction,
    DirectionFriction,
    DirectionViscous,
    FrictionTemperature,
    FrictionWarming,
    FrictionSide,
    FrictionRipple,
    # transmission
    JointCompliance,
    ComplianceTemperature,
    Softening,
    Backlash,
    Hysteresis,
    TransmissionError,
    WristCoupling,
    AxisCoupling,
    # structure
    LinkBending,
    BearingTilt,
    BaseCompliance,
    BaseTorsion,
    # geometry and mass
    PayloadMass,
    UnstatedPayload,
    PayloadCom,
    LinkMass,
    LinkCom,
    LinkInertia,
    RotorInertia,
    JointZero,
    JointSlip,
    LinkLength,
    DressPack,
    SpringBalancer,
    TorqueOffset,
    ThermalGrowth,
    FloorTilt,
    # sensing
    TorqueConstant,
    TorqueSaturation,
    TorqueConstantTemperature,
    CurrentOffset,
    TrackerFrame,
    TrackerDrift,
    TrackerScale,
    ForceGain,
    ForceTilt,
    DriveDelay,
    EncoderDelay,
    LinkEncoderDelay,
    EncoderEccentricity,
    # recording
    ChannelDelay,
    ChannelScale,
    ChannelOffset,
    ChannelDrift,
    ChannelStep,
    TrackerCreep,
    TrackerStep,
    HungLoad,
    BoltedLoad,
)


# what drawings and data sheets leave out of a robot, and any first pass over moving data has
LEFT_OUT = (CoulombFriction.name, ViscousFriction.name, UnstatedPayload.name, DriveDelay.name)
# friction that every drive has, of which a model without any lacks one or both
FRICTION_LEFT_OUT = (CoulombFriction.name, ViscousFriction.name, RollingFriction.name)


def catalogue(files: Iterable[Path] = ()) -> Mapping[str, Effect]:
    """Return all effects by name, in the order of the documentation; those from own files come last.

    Args:
        files: Python files; every subclass of `Effect` that is defined in one becomes an entry.

    Raises:
        InputError: A file cannot be read or run, defines no effect or an incomplete one, or a name is there twice.
    """
    found = {kind.name: kind() for kind in BUILT_IN}
    problems: list[str] = []
    for file in files:
        for kind in _defined_in(file):
            faults = faults_of(kind)
            if not faults and kind.name in found:
                faults = [f"there is an effect {kind.name!r} already; choose another name."]
            problems += [f"{file}: class {kind.__name__}: {fault}" for fault in faults]
            if not faults:
                found[kind.name] = guarded(kind, file)
    if problems:
        raise InputError(problems)
    return found


def _defined_in(file: Path) -> list[type[Effect]]:
    module = _run(file)
    kinds = [
        kind
        for kind in vars(module).values()
        if isinstance(kind, type)
        and issubclass(kind, Effect)
        and kind.__module__ == module.__name__
        and not kind.__name__.startswith("_")
    ]
    if not kinds:
        raise InputError(f"{file}: defines no effect; write a subclass of bench.effects.effect.Effect.")
    return kinds


def _run(file: Path) -> ModuleType:
    if not file.is_file():
        raise InputError(f"{file}: there is no such file.")
    spec = importlib.util.spec_from_file_location(f"own_effects_{file.stem}", file)
    if spec is None or spec.loader is None:
        raise InputError(f"{file}: not a Python file; its name must end in .py.")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a user's file may raise anything, and end
        raise InputError(f"{line_in(file, error)}: does not run: {type(error).__name__}: {error}") from error
    return module
