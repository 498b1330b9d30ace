"""The pitch curve nearest to an outline whose pair of gears can be made."""
