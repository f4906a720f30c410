"""Show: the linear picture of a campaign, in which everything that could be wrong is weighed."""
