"""What the driven shaft turns: the mechanism, its masses, the resistance against its slider."""
