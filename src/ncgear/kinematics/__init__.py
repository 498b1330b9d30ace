"""What the slider does: displacement, velocity, acceleration, force and power over a whole cycle."""
