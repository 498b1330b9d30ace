"""Motion of the slider: displacement, velocity, acceleration, force and power over a whole cycle."""
