"""A robot folder to start from, made of an MJCF or URDF that knows nothing of rotors and elastic elements."""
