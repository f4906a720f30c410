"""A healthy campaign with its robot, spoilt in hundreds of ways; README.md of the repository states what came of it."""
