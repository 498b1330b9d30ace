"""Effects of tolerances on a pair: grades of accuracy, assemblies drawn by chance, and the figures of each."""
