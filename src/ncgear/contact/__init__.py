"""How the two gears touch: as designed, on the exact curves, and as written, on outlines that are read back from files.

placement says how the gears stand, designed and written find the contacts, and pair joins both and refuses bad pairs.
"""
