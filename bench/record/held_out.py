"""Into how many parts what was recorded is cut, each of which is predicted by a model that was fitted to the others."""

BLOCKS = 8  # effort: of the only run, or of one that has to be checked with itself
GAP = 0.25  # assumed: of a block, on both sides of it, which is neither fitted nor predicted
MOST_FOLDS = 40  # effort: of whole runs; beyond that, runs far apart in the campaign share one
