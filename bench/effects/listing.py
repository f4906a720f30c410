"""The catalogue in words, for a terminal and for the documentation."""

import textwrap
from collections.abc import Mapping

from bench.effects.effect import Effect, Parameter
from bench.robot.compiled import CompiledRobot

WIDTH = 110


def listing(effects: Mapping[str, Effect], compiled: CompiledRobot | None = None) -> str:
    """Return a table of effects by family: name, where each may act on a robot if one is given, range of its size."""
    lines: list[str] = []
    family = ""
    for name, effect in effects.items():
        if effect.family != family:
            family = effect.family
            lines += ["", family.upper()]
        place = f"{where(effect, compiled):32}" if compiled else ""
        lines.append(f"  {name:29}{place}{_sizes(effect, compiled)}")
        lines.append(f"  {'':29}{effect.title}")
    return "\n".join(lines).strip("\n")


def entry(effect: Effect, compiled: CompiledRobot | None = None) -> str:
    """Return everything that the catalogue says of one effect, with places and ranges of a robot if one is given."""
    lines = [f"{effect.name}: {effect.title} ({effect.family})", ""]
    lines += textwrap.wrap(effect.physics, WIDTH)
    lines += ["", *([f"acts on   {where(effect, compiled)}"] if compiled else [])]
    if effect.needs:
        lines.append(f"needs     columns {', '.join(effect.needs)}")
    if effect.only_if_told:
        lines.append("needs     a first pass over moving data that has it: nothing else looks for it")
    lines += textwrap.wrap(f"source    {effect.source}", WIDTH, subsequent_indent=" " * 10)
    variants: dict[tuple[Parameter, ...], list[str]] = {}
    for place in effect.places(compiled) if compiled else ():
        assert compiled
        variants.setdefault(effect.parameters_at(compiled, place), []).append(str(place))
    for parameters, named in (variants or {effect.parameters: []}).items():
        lines += ["", f"parameters{' on ' + ', '.join(named) if len(variants) > 1 else ''}"]
        lines += [f"  {p.name:16}{_range(p):34}{p.words}" for p in parameters]
    return "\n".join(lines)


def where(effect: Effect, compiled: CompiledRobot) -> str:
    """Return where an effect may act on a robot, in words."""
    places = effect.places(compiled)
    if not places:
        return "not on this robot as it stands" if effect.level == "machine" else "runs or channels"
    if places[0].kind == "robot":
        return "the robot"
    if places[0].kind == "joint":
        return "joints " + ", ".join(str(place.index + 1) for place in places)
    names = ", ".join(place.name for place in places)
    return names if len(names) <= 26 else f"{len(places)} bodies"


def markdown_table(effects: Mapping[str, Effect]) -> str:
    """Return the table of the documentation."""
    lines = ["| effect | what it is | parameters | source |", "|---|---|---|---|"]
    for effect in effects.values():
        parameters = "; ".join(f"`{p.name}` {_range(p)}" for p in effect.parameters)
        lines.append(f"| `{effect.name}` | {_cell(effect.physics)} | {parameters} | {_cell(effect.source)} |")
    return "\n".join(lines)


def _sizes(effect: Effect, compiled: CompiledRobot | None) -> str:
    """Return the range of the first parameter over all places; without a robot that of the catalogue."""
    at_places = [effect.parameters_at(compiled, place)[0] for place in effect.places(compiled)] if compiled else []
    at_places = at_places or [effect.parameters[0]]
    first = at_places[0]
    low, high = min(p.low for p in at_places), max(p.high for p in at_places)
    return f"{first.name} {_text(low, high, first)}"


def _range(parameter: Parameter) -> str:
    if parameter.is_shape:
        unit = f" {parameter.unit}" if parameter.unit else ""
        return f"{parameter.null:.3g} ({parameter.low:.3g} to {parameter.high:.3g}){unit}"
    return _text(parameter.low, parameter.high, parameter)


def _text(low: float, high: float, parameter: Parameter) -> str:
    sign = "+-" if parameter.signed else ""
    base = f"{parameter.null:.3g} + " if parameter.null else ""
    unit = f" {parameter.unit}" if parameter.unit else ""
    return f"{base}{sign}({low:.3g} to {high:.3g}){unit}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
