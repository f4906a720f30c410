"""The defaults of `figures.yaml` as a table for people; a test holds models/README.md to it."""

from pydantic import BaseModel

from bench.robot.figures import (
    CurrentSensor,
    Drive,
    Encoder,
    ForceSensor,
    LinkEncoder,
    PressureGauge,
    TorqueSensor,
    Tracker,
    Uncertainty,
)

PARTS: tuple[tuple[str, type[BaseModel]], ...] = (
    ("drives[]", Drive),
    ("instruments.tracker", Tracker),
    ("instruments.force", ForceSensor),
    ("instruments.current", CurrentSensor),
    ("instruments.torque", TorqueSensor),
    ("instruments.encoder", Encoder),
    ("instruments.link_encoder", LinkEncoder),
    ("instruments.pressure", PressureGauge),
    ("uncertainty", Uncertainty),
)
# Defaults that are no numbers
IN_WORDS = {
    "torque_constant_nm_per_a": "an error where currents are given",
    "payload_kg": "the rated load",
    "zeroing_sigma_rad": "all of `offset_sigma_rad`",
}


def table() -> str:
    """Return all figures with their defaults in Markdown, as they stand in models/README.md."""
    lines = ["| key | unless given | is |", "|---|---|---|"]
    for place, kind in PARTS:
        for name, field in kind.model_fields.items():
            if kind is Drive and not isinstance(field.default, float):
                continue  # names of parts
            default = IN_WORDS[name] if name in IN_WORDS else _said(field.default, field.is_required())
            lines.append(f"| `{place}.{name}` | {default} | {field.description} |")
    return "\n".join(lines)


def _said(default: object, is_required: bool) -> str:
    if is_required:
        return "must be given"
    return f"{default:g}"
