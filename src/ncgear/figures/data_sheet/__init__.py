"""What a drawing of the gears needs, as rows and tables."""
