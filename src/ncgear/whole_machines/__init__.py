"""Whole machines: law, flywheel, gears, material and process, searched together, and rated from their files only."""
