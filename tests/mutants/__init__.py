"""Do the tests bite?  Lines of mathematics are broken one at a time, and the tests that run them have to fail.

    python -m mutants --each 10 --seed 0 [--tests quick] [--room teeth ...]

draws ten mutations of each room, and writes what survives to ``export/mutants``; ``make mutants`` does it for the
tests of README's command.  ``survivors.md`` keeps those that are known, each with its reason.
"""
