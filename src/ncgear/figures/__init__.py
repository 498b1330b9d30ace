"""Results as values and as text: summary, comparison, advice, data sheet, tables."""
