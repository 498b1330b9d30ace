"""Forces in the machine: of its moving masses, of the resistance and of the teeth."""
