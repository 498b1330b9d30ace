"""The figures of four papers, computed and judged."""
