"""Wishes for the output's motion: their requirements on a law, and their outcome for a motion."""
