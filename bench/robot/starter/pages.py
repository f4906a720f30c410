"""The text files of a started robot: figures, scene, log format, and a page that says where every number comes from."""

from collections.abc import Sequence

import yaml
from pydantic import BaseModel

from bench.record.units import STANDARD_GRAVITY
from bench.record.yaml_text import in_quotes
from bench.robot.figures import Uncertainty
from bench.robot.instruments import Encoder, TorqueSensor, Tracker
from bench.robot.starter.assumed import ROTOR_KEPT, assumptions, is_kept
from bench.robot.starter.defaults import ROTOR_GUESSED, DriveFigures, Survey
from bench.robot.starter.mjcf import names_of, reflectors_of
from bench.robot.starter.source import Source

LOAD_SHARE = 0.2  # assumed: of what the strongest drive holds, the rated load
SHORTEST = 0.1  # assumed: [m], lever of a load, however short the arm
DRAWING = {"mass": 0.05, "centre_of_mass_m": 5e-3, "geometry_m": 0.5e-3, "axis_rad": 5e-4, "friction": 0.2}  # assumed
PULLS = {"pull": 0.005, "pull_rad": 0.005}  # assumed: as of a force sensor
# Of the stiffness, which no file has: a factor of four. Joints of the HH-150 lie within a factor of 2.1 of the guess,
# data sheets of gears alone five times above it
STIFFNESS_GUESSED = 3.0
SIGMA_SHARE = 0.002  # assumed: of the torque limit: noise of a torque reading, and its offset


def figures_text(name: str, source: Source, drives: Sequence[DriveFigures], found: Survey) -> str:
    """Return `figures.yaml`."""
    pairs = list(zip(source.joints, drives, strict=True))
    lines = [
        f"# Figures of {name}, started from {source.file.name}. What is marked default is a guess.",
        "# Keys: models/README.md and bench/robot/figures.py. Of a joint that slides, rad stands for m and nm for n.",
        f"title: {in_quotes(name)}",
        f"mjcf: {name}.xml",
        "scene: scene.xml",
        "",
        "drives:",
    ]
    for joint, drive in pairs:
        keys = names_of(joint.name)
        lines.append(f"  - joint: {_quoted(keys.pop('joint'))}")
        lines += [f"    {key}: {_quoted(value)}" for key, value in keys.items()]
        lines += [
            "    # torque_constant_nm_per_a:  of a drive that reports current: Nm at the joint per A; else left out",
            "    # gear_ratio:  where logs have angles of the motors: turns of the motor to one of the joint",
            f"    speed_limit_rad_per_s: {drive.speed_limit:g}  # {drive.origins['speed_limit']}",
        ]
    heaviest = held_kg(source, drives, found)
    force = LOAD_SHARE * heaviest * STANDARD_GRAVITY
    sigmas = [_rounded(SIGMA_SHARE * drive.torque_limit) for drive in drives]
    lines += [
        "",
        f"load_body: bench_load  # {source.load_point.origin}",
        "load_point: bench_load_point",
        _reflectors(source),
        "",
        "rating:  # default: a fifth of what the strongest drive holds, a hinge at full reach",
        f"  force_n: {_rounded(force):g}",
        f"  moment_nm: {_rounded(0.1 * force * max(found.lever, SHORTEST)):g}",
        "",
        "instruments:  # null: not there",
        "  tracker:",
        f"    position_m: [{max(3.0, 2 * found.reach):.2g}, 0.5, 0.5]  # default",
        *_defaults(Tracker),
        "  force: null",
        "  current: null  # default: the drives report torque; drives that report current: {} here, torque: null",
        "  torque:",
        f"    sigma_nm: [{', '.join(f'{one:g}' for one in sigmas)}]  # default: 0.2 % of the torque limit",
        *_defaults(TorqueSensor, offset_sigma_nm=sigmas),
        "  encoder:",
        *_defaults(Encoder, resolution_rad=1e-6),
        "  link_encoder: null",
        "  pressure: null",
        "",
        "uncertainty:  # default: a model taken from a drawing",
        *_defaults(
            Uncertainty,
            "  ",
            **DRAWING,
            **PULLS,
            stiffness=STIFFNESS_GUESSED,
            rotor_inertia=_of_rotors(drives),
            payload_kg=heaviest,
        ),
        "",
        "assumed:  # bench check shows these lines; take out what you have replaced",
        *(f"  - {in_quotes(line)}" for line in assumptions(source, drives, heaviest)),
    ]
    return "\n".join(lines) + "\n"


def _reflectors(source: Source) -> str:
    """Return the line of `figures.yaml` that names the reflectors."""
    why = "; ".join(place.origin for place in source.reflectors)
    why = why or "default: in the load point; three or more that are not in line tell more"
    return f"reflectors: [{', '.join(reflectors_of(source))}]  # {why}"


def _rounded(value: float) -> float:
    return float(f"{value:.2g}")


def held_kg(source: Source, drives: Sequence[DriveFigures], found: Survey) -> float:
    """Return what the strongest drive holds up at full reach [kg], to two digits; of those that weight acts on."""
    lever = max(found.lever, SHORTEST)
    forces = [
        drive.torque_limit / (1.0 if joint.is_slide else lever)
        for joint, drive in zip(source.joints, drives, strict=True)
    ]
    bearing = [force for force, bears in zip(forces, found.bears, strict=True) if bears]
    return _rounded(max(bearing or forces) / STANDARD_GRAVITY)


def _of_rotors(drives: Sequence[DriveFigures]) -> float | list[float]:
    """Return how well rotors are known: one number, or one for each drive where the file states some of them."""
    known = [ROTOR_KEPT if is_kept(drive, "rotor_inertia") else ROTOR_GUESSED for drive in drives]
    return known if len(set(known)) > 1 else known[0]


def _defaults(kind: type[BaseModel], indent: str = "    ", **other: float | list[float]) -> list[str]:
    """Return a line for each figure that has a default."""
    lines = []
    for name, field in kind.model_fields.items():
        if not field.is_required():
            value = other.get(name, field.default)
            is_list = isinstance(value, list)
            text = f"[{', '.join(f'{one:g}' for one in value)}]" if is_list else f"{value:g}"
            lines.append(f"{indent}{name}: {text}  # default{', drive by drive' if is_list else ''}")
    return lines


def scene_text(name: str) -> str:
    """Return `scene.xml`."""
    return (
        f'<mujoco model="{name} scene">\n  <include file="{name}.xml"/>\n\n  <worldbody>\n'
        '    <light type="directional" pos="2 -3 5" dir="-0.35 0.5 -0.8"/>\n'
        '    <geom type="plane" size="0 0 0.05" contype="0" conaffinity="0" rgba="0.5 0.52 0.54 1"/>\n'
        "  </worldbody>\n</mujoco>\n"
    )


def log_text(source: Source) -> str:
    """Return a `log.yaml` whose names are those of a campaign, to be edited."""
    lines = [
        "# How your logs read: on the left a column of a campaign, on the right the column of your log, and its factor",
        "# (unit, gear ratio, sign). Take out what you do not record, or mark it optional. All keys stand in",
        "# bench/record/logs/README.md; `bench convert --look LOG --robot DIR` proposes such a file.",
        "kind: motion",
        "columns:",
        "  time_s: {from: time_s}",
    ]
    for quantity, hinge, slide in (("q_cmd", "rad", "m"), ("q_motor", "rad", "m"), ("tau_motor", "nm", "n")):
        for number, joint in enumerate(source.joints, start=1):
            column = f"{quantity}_{number}_{slide if joint.is_slide else hinge}"
            optional = ", optional: true" if quantity == "q_cmd" else ""
            lines.append(f"  {column}: {{from: {column}, factor: 1.0{optional}}}")
    return "\n".join(lines) + "\n"


def readme_text(name: str, source: Source, drives: Sequence[DriveFigures], found: Survey) -> str:
    """Return `README.md`: what was taken from the file, what was added, and what to replace first."""
    lines = [
        f"# {name}",
        "",
        f"Started by `bench new-robot` from `{source.file.name}`. Links, masses, inertias and shapes are that file's.",
        "Rotors, elastic elements, servos, friction elements and the load body were added; contacts were switched off.",
        "",
        f"- Load point: {source.load_point.origin}.",
        *(f"- Reflector {k}: {place.origin}." for k, place in enumerate(source.reflectors, start=1)),
        f"- Left out: {', '.join(source.left_out) or 'nothing'}.",
        *(f"- {sentence}" for sentence in source.lost_balance),
        "- Actuators of the file are not kept: the servo of the bench tracks what a recording says was commanded.",
        "- Time step and integrator are those of the bench.",
        "",
        "## Assumed",
        "",
        "What the file does not say. `bench check` repeats these lines for each campaign of this robot; replace the",
        "figure and take its line out of `assumed` in `figures.yaml`.",
        "",
        *(f"- {line}" for line in assumptions(source, drives, held_kg(source, drives, found))),
        "",
        "## Joint by joint",
        "",
        "| joint | rotor J N² | stiffness | damping | viscous | Coulomb | torque limit | speed limit |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for joint, d in zip(source.joints, drives, strict=True):
        values = (d.rotor_inertia, d.stiffness, d.damping, d.viscous, d.coulomb, d.torque_limit, d.speed_limit)
        lines.append(f"| {joint.name} | {' | '.join(f'{value:g}' for value in values)} |")
    lines += ["", "SI units; of a hinge kg m², Nm/rad, Nm s/rad, Nm, rad/s; of a slide kg, N/m, N s/m, N, m/s.", ""]
    for key in ("rotor_inertia", "stiffness", "viscous", "coulomb", "torque_limit", "speed_limit"):
        words: dict[str, list[str]] = {}
        for joint, d in zip(source.joints, drives, strict=True):
            words.setdefault(d.origins[key], []).append(joint.name)
        lines.append(
            f"- {key.replace('_', ' ')}: " + "; ".join(f"{', '.join(who)}: {why}" for why, who in words.items())
        )
    lines += [
        "",
        "Damping of the elements (ratio 0.05), presliding stiffness, servo gains, rating and instruments are defaults;",
        "those of instruments stand in `figures.yaml`, and what they mean in models/README.md of the bench.",
        "The speed limit stands in `figures.yaml` alone, the torque limit in the MJCF alone (`forcerange`).",
        "",
        "## What to replace first",
        "",
        "1. Rotor inertia times the square of the gear ratio, and the stiffness of the gears, in the MJCF.",
        "2. What the drives report, and how well: `instruments` in `figures.yaml`. A drive that reports current needs",
        "   `torque_constant_nm_per_a` (motor constant times gear ratio), `current: {}` and `torque: null`. Where",
        "   nobody knows it, `bench convert --look LOG --robot DIR` estimates it against masses and says how well.",
        "3. How your logs read: `log.yaml`. Then `bench convert`, `bench check`, `bench diagnose`.",
    ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    """Return a text as YAML has it; in quotation marks unless it is one word that YAML takes for a text."""
    is_word = text.replace("_", "").replace("-", "").isalnum() and not text[0].isdigit()
    return text if is_word and yaml.safe_load(text) == text else in_quotes(text)
