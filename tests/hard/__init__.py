"""Hard cases: how they are judged, and the table of what came out."""
