"""What a log seems to hold: guessed from the names of its columns, from their values; with reasons."""
