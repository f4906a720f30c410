"""`bench identify --method dynamics`: the first pass for people and as JSON."""
