"""The study: hundreds of campaigns with hidden effects, diagnosed blind, and only then held against the truth."""
