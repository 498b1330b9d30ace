"""What shakes the frame, and what mass where would stop it: linkages, gears and rotors."""
