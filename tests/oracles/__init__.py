"""Independent references for the tests: none of them imports or mirrors the package under test."""
