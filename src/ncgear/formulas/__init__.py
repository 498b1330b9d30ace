"""A law in closed form, piece by piece, as expressions of sympy: made, compared with its numbers, printed."""
