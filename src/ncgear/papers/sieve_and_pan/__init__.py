"""C. Wei, L. Xu, J. Wang, Y. Li: the sieve and the return pan of a combine harvester."""
