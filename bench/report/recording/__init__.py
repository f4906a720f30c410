"""A film as a Rerun recording: the robot, what acts on it, what the instruments saw."""
