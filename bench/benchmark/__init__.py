"""What the bench costs: processor time and ratios that hold on a busy machine."""
