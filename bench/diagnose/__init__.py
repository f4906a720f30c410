"""From measured data to what the simulation gets wrong and the cause of it. README.md has the way."""
