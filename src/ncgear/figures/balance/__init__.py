"""The figures of a balance file, part by part, and their text."""
