"""The certified limit: what no law can be below, and motions that show how near to it one can come."""
