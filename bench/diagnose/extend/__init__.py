"""Extend: the model with causes in it, fitted by simulation."""
