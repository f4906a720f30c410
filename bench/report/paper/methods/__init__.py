"""Which method to trust, over friction and ways of measuring."""
