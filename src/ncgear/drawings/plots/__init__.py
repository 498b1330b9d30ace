"""Pictures as PNG bytes: motion, loads, gears, contact, balance, frontier."""
