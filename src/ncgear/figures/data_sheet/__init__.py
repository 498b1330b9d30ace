"""The data that a drawing of the gears needs, as rows and tables."""
