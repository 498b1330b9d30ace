"""What is possible: certified limits, best laws of families, makeable laws."""
