"""What a person may wish of the output's motion: what each wish asks of a law, and what a motion achieves of it."""
