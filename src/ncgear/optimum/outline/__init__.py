"""The pitch curve nearest to an outline that gives a makeable pair of gears."""
