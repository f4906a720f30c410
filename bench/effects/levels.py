"""Where an effect may act in several recordings of one machine: in all of them alike, or in one of them."""

from dataclasses import replace

from bench.effects.effect import Effect, Place
from bench.effects.recorded import Recorded
from bench.robot.compiled import CompiledRobot


def places_of(effect: Effect, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
    """Return where an effect may act on a robot in a campaign.

    What stays the same acts in all recordings alike. An error of a recording, and what is another one each time (a
    payload, the tracker's frame), is looked for in each recording by itself, by what was recorded in that one. What
    drifts (gas that is lost) has both kinds of places. In a campaign of one recording all places are those of it.

    Args:
        effect: What.
        compiled: The robot.
        recorded: Runs and columns of the campaign.
    """
    everywhere = effect.places_in(compiled, recorded)
    if len(recorded.recordings) < 2 or (effect.level == "machine" and effect.between == "same"):
        return everywhere
    in_one = tuple(
        replace(place, recording=name)
        for name, own in recorded.recordings.items()
        for place in effect.places_in(compiled, own)
    )
    return (*everywhere, *in_one) if effect.level == "machine" and effect.between == "drifts" else in_one


def acts_in(place: Place, recording: str) -> bool:
    """Whether what acts at a place acts in a recording."""
    return place.recording in (None, recording)
