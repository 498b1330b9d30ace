"""Best laws: certified limits, best laws of families, makeable laws."""
