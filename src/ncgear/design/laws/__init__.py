"""The motion laws as design files know them: one module for each law, and the registry that lists them."""
