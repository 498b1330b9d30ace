"""Laws that gears can follow: harmonics of ln i12, the best under all limits."""
