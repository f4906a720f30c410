"""`bench effects`: what can be wrong with a model, and how much."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Effects:
    """List the catalogue of effects that a nominal model leaves out; with a name, everything about one."""

    name: Annotated[str | None, tyro.conf.Positional] = None
    """Of one effect; all, if left out."""
    robot: str | None = None
    """Robot whose places and ranges to print: a name in models/ or a folder; if left out, those of the catalogue."""
    file: tuple[Path, ...] = ()
    """Python files with effects of your own (bench/effects/README.md)."""

    def run(self) -> int:
        """Print; return the exit code."""
        from bench.effects.catalogue import catalogue
        from bench.effects.listing import entry, listing
        from bench.errors import InputError, unknown_name
        from bench.robot.compiled import compile_robot
        from bench.robot.folder import load_robot

        effects = catalogue(self.file)
        if self.name is not None and self.name not in effects:
            raise InputError(unknown_name("effect", self.name, effects))
        compiled = compile_robot(load_robot(self.robot)) if self.robot else None
        print(entry(effects[self.name], compiled) if self.name else listing(effects, compiled))
        return 0
