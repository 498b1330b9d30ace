"""What of the documentation is made by a program: heads of the command pages, the table of keys, the pictures."""
