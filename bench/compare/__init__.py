"""What changed on a machine between recordings of it, when nothing that stayed as it was is blamed (README.md)."""
