"""Linear identification of the dynamics from moving data: the first pass, and the rival of every diagnosis."""
