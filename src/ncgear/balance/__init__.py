"""Shaking of the frame, and masses that reduce it: linkages, gears and rotors."""
