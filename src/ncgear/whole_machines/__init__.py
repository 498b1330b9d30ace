"""Whole machines: law, flywheel, gears, material and process found together, and rated from their files alone."""
