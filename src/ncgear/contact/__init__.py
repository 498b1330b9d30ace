"""Contact of the teeth: of the exact flanks, and of the outlines as they are written."""
