"""The return period: a degree-5 polynomial that joins the working stroke smoothly and closes the cycle.

Value and slope of the ratio are given at both ends, the driven angle of the return by closure.  Of the six
coefficients one stays free; the published method calls it e, the polynomial's value extrapolated to phi1 = 0
(J. Wang et al., eqs. (3.8) to (3.12), where "f5" is one coefficient too many).  It is given, or chosen so that the
slider's peak acceleration in the return is least.

Two bases: the polynomial is i12 (closure by a one-dimensional solve), or 1/i12 (closure is linear).  Both are written
in tau = (phi1 - start) / (end - start): the Hermite cubic of the end conditions plus multiples of tau^2 (1 - tau)^2,
which changes neither end.
"""
