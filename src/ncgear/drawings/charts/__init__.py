"""Charts as values, built from a drive, and the one drawer that puts them onto axes."""
