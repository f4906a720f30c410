"""Logs as robots give them: how their tables are written, their clocks and rates, and what is cut out of them."""
