"""What there is to see of a machine, and where it is at any driving angle; drawn by what hands results over."""
