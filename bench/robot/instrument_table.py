"""The defaults of `figures.yaml` as a table for people; a test holds models/README.md to it."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from bench.robot.figures import Drive, Uncertainty
from bench.robot.instruments import (
    CurrentSensor,
    Encoder,
    ForceSensor,
    LinkEncoder,
    PressureGauge,
    TorqueSensor,
    Tracker,
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
    "drives[].torque_constant_nm_per_a": "an error where currents are given",
    "uncertainty.payload_kg": "the rated load",
    "instruments.link_encoder.zeroing_sigma_rad": "all of `offset_sigma_rad`",
}


def table() -> str:
    """Return all figures with their defaults in Markdown, as they stand in models/README.md."""
    lines = ["| key | unless given | can be | is |", "|---|---|---|---|"]
    for place, kind in PARTS:
        schemas = kind.model_json_schema()["properties"]
        for name, field in kind.model_fields.items():
            if kind is Drive and not isinstance(field.default, float):
                continue  # names of parts
            key = f"{place}.{name}"
            default = IN_WORDS[key] if key in IN_WORDS else _said(field.default, field.is_required())
            lines.append(f"| `{key}` | {default} | {_range(schemas[name])} | {field.description} |")
    return "\n".join(lines)


def _said(default: object, is_required: bool) -> str:
    if is_required:
        return "must be given"
    return f"{default:g}"


def _range(schema: Any) -> str:
    """Return in words between which numbers a figure can be, from its JSON schema; "names" where it is no number."""
    bounds = dict(_bounds(schema))
    if "maximum" not in bounds:
        return "names"
    if "minimum" in bounds:
        return f"{bounds['minimum']:g} to {bounds['maximum']:g}"
    return f"above {bounds['exclusiveMinimum']:g}, to {bounds['maximum']:g}"


def _bounds(schema: Any) -> Iterator[tuple[str, float]]:
    """Yield the bounds that stand in a schema, in whatever they are nested."""
    parts = schema.items() if isinstance(schema, dict) else enumerate(schema) if isinstance(schema, list) else ()
    for key, part in parts:
        if key in ("minimum", "exclusiveMinimum", "maximum"):
            yield key, part
        else:
            yield from _bounds(part)
