"""The mathematics of the motion laws, one module each; every law is a function that returns a Transmission."""
