"""What tolerances do to a pair: grades of accuracy, assemblies drawn by chance, what each of them does."""
