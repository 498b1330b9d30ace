"""Formats for workshops, printers and CAD."""
