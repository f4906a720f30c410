"""Results for people: tables, figures, recordings; scoring against the truth."""
