"""What ``ncgear simulate`` hands over."""
