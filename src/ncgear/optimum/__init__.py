"""What is possible: the certified limit of acceleration and power, whatever the law."""
