"""What a drive was found to be: the contents of summary.json."""
