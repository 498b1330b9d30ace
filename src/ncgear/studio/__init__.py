"""The studio: one design on a page of this computer; answers are computed while its values are dragged."""
