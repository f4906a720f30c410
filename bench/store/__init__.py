"""Arrays that took long to compute, kept on disk by content (README.md)."""
