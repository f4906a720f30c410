"""When a joint moves: less than that, and it gives under load or stands, and its friction is not at its level."""

# assumed: [rad] or [m]; a motor that goes less far in a run only gives under load: its friction does not slide
TRAVELS = 0.005
# assumed: of a joint's top speed in a run; below it friction is as it happens to be about starts, stops and turns
TURNING = 0.08
# effort: [s], within which friction that falls during a session is one level; at 1/h it falls by less than 2 %
TIME_STEP_S = 60.0
FEWEST_TIMES = 3  # derived: a fall over time is told from any other difference by a third time at least
FEWEST_ROWS = 5  # exact: of a motion, from which a speed and an acceleration are told; a shorter one is left out
