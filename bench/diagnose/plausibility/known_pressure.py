"""Pressures that the lab knows besides, held against the nominal model as those that a gauge logs are."""

from collections.abc import Iterator
from dataclasses import replace

from bench.diagnose.plausibility.displaced import is_of_gas, pressure_unit
from bench.diagnose.plausibility.repeated import Repeated
from bench.diagnose.replay.known import known_quantities, with_known_segments
from bench.diagnose.replay.world import NOMINAL
from bench.record.finding import Finding
from bench.record.manifest import MANIFEST


def known_pressures(repeated: Repeated) -> Iterator[Finding]:
    """Yield a doubt for each known pressure that gas cannot have in its pose.

    Args:
        repeated: The campaign.
    """
    campaign, compiled, segments = repeated.campaign, repeated.compiled, repeated.segments
    for i, one in enumerate(campaign.known):
        if one.quantity != "gas_pressure_pa":
            continue
        alone = replace(campaign, known=(one,))
        quantities = known_quantities(alone, compiled)
        every = with_known_segments(segments, alone, compiled, quantities)
        rests = tuple(segment for segment in every if not any(segment is other for other in segments))
        if rests:
            ratio = one.value / float(repeated.replay(rests, quantities).predict(NOMINAL)[0, 0])
            if not is_of_gas(ratio):
                message = f"{one.value:g} Pa is {ratio:.2g} times what the model has in that pose"
                remedy = f"{pressure_unit(ratio)}? give pascals above ambient"
                yield Finding("doubt", MANIFEST, None, f"known[{i}].value", message, remedy)
