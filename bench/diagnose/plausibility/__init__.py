"""Plausibility check: channels that are hardly what their names say."""
