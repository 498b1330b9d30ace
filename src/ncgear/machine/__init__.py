"""Machine elements: the crank-slider linkage, the slider's working stroke, the resistance, the basic rack."""
