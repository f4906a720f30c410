"""A `log.yaml` proposed for a log that nobody has described."""
