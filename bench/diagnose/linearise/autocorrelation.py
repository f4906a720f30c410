"""How many neighbours in time err together."""

from collections.abc import Sequence

from bench.record.campaign import Array

MOST_LAGS = 50  # effort: over which the correlation of neighbours is summed
FEW = 10  # declared: pairs that say nothing of a correlation


def alike(sequences: Sequence[Array]) -> float:
    """Return the integrated autocorrelation of sequences with mean zero, summed until it turns negative; 1 at least."""
    count = sum(len(s) for s in sequences)
    power = sum(float(s @ s) for s in sequences)
    total = 1.0
    longer = list(sequences)
    for lag in range(1, MOST_LAGS):
        longer = [s for s in longer if len(s) > lag]
        pairs = sum(map(len, longer)) - lag * len(longer)
        if power <= 0 or pairs < FEW:
            break
        product = sum([float(s[lag:] @ s[:-lag]) for s in longer])
        correlation = (product / pairs) / (power / count)
        if correlation <= 0:
            break
        total += 2 * correlation
    return total
