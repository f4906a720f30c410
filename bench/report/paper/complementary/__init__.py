"""Section 4.2: where K_C can be left out."""
