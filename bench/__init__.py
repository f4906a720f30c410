"""A virtual test bench for heavy industrial robots with a counterbalance: simulate, identify, diagnose."""

from gymnasium import register

__version__ = "0.1.0"

register(id="Bench-v0", entry_point="bench.environment.entry:make")  # gymnasium.make("bench:Bench-v0")
