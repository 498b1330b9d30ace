"""From what a design file says to what is computed with: units, defaults, and what must fit together."""
