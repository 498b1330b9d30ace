"""The laws a design can name, one module each; every one returns a Transmission."""
