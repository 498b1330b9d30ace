"""Do the tests bite?  Lines of mathematics are broken one at a time, and the tests that run them have to fail.

    python -m mutants --each 8 --seed 38 [--tests quick] [--room teeth ...]

draws eight mutations of each room, and writes ``benchmarks/mutants.md``, with the reasons of ``reasons.yaml``.  ``make
mutants`` does it for the tests of README's command.  All tests are collected once.  Each mutation is put into a process
that is forked off, into its functions, where all tests that run its line run, first those that run little else, and
then others of their files, which may use what those have kept.  What is known is kept in ``export/mutants``, while
modules and test files stay as they are.
"""
