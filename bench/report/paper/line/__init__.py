"""Section 6: the UV line, predicted and compensated."""
