"""When a joint moves: less than that, and it gives under load or stands, and its friction is not at its level."""

# assumed: [rad] or [m]; a joint that goes less far in a run only gives: elastic elements of these arms give by a fifth
# of that under their largest loads, and friction has slid long before
TRAVELS = 0.005
# assumed: of a joint's top speed in a run; below it, it starts, stops or turns round
TURNING = 0.08
