"""The whole paper on the virtual robot, one folder per chapter."""
