"""Robot folders: figures, compiled model, links as plain numbers, counterbalance."""
