"""What ncgear hands over: tables, meshes, plots, reports, and how they reach the output folder."""
