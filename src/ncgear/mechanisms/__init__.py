"""The mechanism on the driven shaft, its masses, and the resistance against its slider."""
