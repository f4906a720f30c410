"""Whether data tell a number, or it comes back as it was known before: one rule for first pass, diagnosis and others.

Of a number whose prior has the variance p, data that hold the information i about it leave the variance s, with
1/s = 1/p + i; its estimate is the mean of what data and prior say, with weights i s and s/p. Data tell it where they
say more of it than was known without them: i > 1/p. Then they have more than half of the weight, and s < p/2.
"""


def is_told(variance: float, prior: float) -> bool:
    """Return whether data say more of a number than was known of it without them.

    Args:
        variance: Of its estimate, data and prior together.
        prior: Variance of its prior; nan where there is none, and data say all.
    """
    return not variance >= prior / 2
