"""Table 5 and the loading experiment in each friction world."""
