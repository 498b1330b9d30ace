"""The figures of six publications, computed and judged."""
