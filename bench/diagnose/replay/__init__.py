"""Replay: what a campaign did, and what every instrument should have shown."""
