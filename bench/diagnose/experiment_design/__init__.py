"""Ask: the next experiment, and what this campaign could not show."""
