"""The data sheet of a pair of gears: what a drawing needs beside the outline."""
