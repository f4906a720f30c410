"""What secondary encoders, behind the gear, say that is not so."""

from dataclasses import replace

from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Effect, Parameter, Place, Values
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace


class LinkEncoderDelay(Effect):
    """The angles behind the gear are older, or newer, than the rest of their row."""

    name = "link_encoder_delay"
    family = "sensing"
    title = "delay of the link encoders"
    physics = (
        "Secondary encoders are read by another device than the motors': they read theta - d dtheta/dt. It is told "
        "from compliance by speed: the difference of both encoders follows velocity, not torque."
    )
    source = "Swevers, Verdonck and De Schutter, 2007 (synchronised sampling); range: up to two cycles of 5 ms, assumed"
    parameters = (Parameter("delay", "s", 0.0, 5e-4, 10e-3, "d, of all of them, against the motors'", signed=True),)

    def places(self, compiled: CompiledRobot) -> tuple[Place, ...]:
        """Return the robot if it has secondary encoders."""
        return (WHOLE,) if compiled.robot.figures.instruments.link_encoder else ()

    def distort(self, place: Place, values: Values, reading: Reading, trace: Trace, conditions: Conditions) -> Reading:
        return replace(reading, q_link=reading.q_link - values["delay"] * trace.theta_velocity)
