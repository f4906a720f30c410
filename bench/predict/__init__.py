"""A model held against recordings that it was not fitted to."""
