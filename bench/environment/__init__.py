"""The Gymnasium environment as `gymnasium.make` gives it: one robot, or robots drawn from what a diagnosis knows."""
