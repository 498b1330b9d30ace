"""What a designer should know before cutting metal, in plain words: what there is and where, and what to change."""
