"""Numerical tools that know nothing of gears: Taylor arithmetic, piecewise Chebyshev forms, quadrature, extrema."""
