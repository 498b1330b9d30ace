"""What the machine feels: forces of its moving masses, of the resistance and of the teeth."""
