"""What the driven shaft turns: linkage, masses, resistance."""
