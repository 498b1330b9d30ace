"""Drawings of gears and of their assembly on sheets of paper, for people who make and mount them."""
