"""Files for the workshop: drawings and meshes that other programs read."""
