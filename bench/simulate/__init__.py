"""The robot in time and at rest, its instruments, and the policies that drive it."""
