"""Pictures that are not charts, as PNG: the assembled pair, balance, frontier; and parts that all pictures share."""
