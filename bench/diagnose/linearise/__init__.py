"""Show: the linearised model of a campaign, in which everything that could be wrong is weighed."""
