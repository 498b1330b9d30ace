"""What ncgear balance says and draws."""
