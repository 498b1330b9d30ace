"""Advices: special features of a design, and the changes that would cure them."""
