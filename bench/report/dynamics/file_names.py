"""What a first pass writes into its folder."""

DYNAMICS = "dynamics.json"
