"""From text to checked values, with the line and column of every fault."""
