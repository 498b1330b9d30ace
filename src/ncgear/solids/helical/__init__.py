"""Helical and herringbone teeth: sections, stacks and the surfaces through them."""
