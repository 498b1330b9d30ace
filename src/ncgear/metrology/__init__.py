"""Measurements of a workshop on a finished gear, from the exact curves of its teeth."""
