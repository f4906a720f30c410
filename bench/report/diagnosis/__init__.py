"""A diagnosis for people: words on the terminal, verdict.json, report page, recording."""
