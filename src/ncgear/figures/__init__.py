"""What is told: summary, data sheet, comparison, advice, as values and text."""
