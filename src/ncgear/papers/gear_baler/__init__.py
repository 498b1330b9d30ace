"""J. Wang, C. Wang, L. Miao: the non-circular gears of a baler."""
