"""The studio: one design on a page of this computer, each answer computed while its values are dragged."""
