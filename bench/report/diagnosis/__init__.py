"""A diagnosis for people: words on the terminal, verdict.json, the extended model and its difference."""
