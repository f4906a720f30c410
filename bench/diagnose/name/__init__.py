"""Name: from evidence to a cause, a set of causes, or the word that it is none that is listed."""
