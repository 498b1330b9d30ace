"""Pictures that are not charts, as PNG: the assembled pair, balance, frontier; and what all pictures share."""
