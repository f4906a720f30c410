"""Measure: what an extension is worth on what was held out."""
