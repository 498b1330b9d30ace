"""Speed against error: what each stage's accuracy costs, by the methods it could use."""
