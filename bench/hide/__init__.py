"""Data with effects that a diagnosis is not told of, made by a simulation that differs from the one it replays with."""
