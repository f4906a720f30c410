"""A second plant: an elastic-joint arm in quasi-static balance, which shares no code with the first one."""
