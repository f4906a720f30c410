"""The next measuring poses for a robot: what is asked for, the plan, and the plan as tables and files."""
