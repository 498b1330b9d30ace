"""What is special about a design, and what would change it."""
