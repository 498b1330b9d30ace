"""Contact of the two gears: as designed, on the exact curves, and as written, on outlines read back from files.

placement places the gears, designed and written find the contacts, and pair joins both and refuses bad pairs.
"""
