"""Charts as values, built from a drive, and the drawer that puts them onto axes."""
