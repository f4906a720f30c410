"""What `bench.robot.patched` is made of: edits noted, structures compiled, numbers and texts written into models."""
