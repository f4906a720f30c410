"""Section 5: the counterbalance from rotations."""
