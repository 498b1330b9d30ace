"""The certified limit: no law has a lower value, and motions show how near a law can come to it."""
