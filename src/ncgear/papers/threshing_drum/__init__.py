"""Z. Yu, Y. Li, X. Wang, Z. Tang, J. Lu: a threshing drum with a chain drive at its side."""
