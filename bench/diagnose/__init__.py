"""From measured data to what the simulation gets wrong: replay, show, name, extend, measure, ask. README.md has the way."""
