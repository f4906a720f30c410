"""Recordings: the campaign format, its reader, its checks and its writer, and the truth that is kept apart from it."""
