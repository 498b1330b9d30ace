"""What ``ncgear bench`` hands over."""
