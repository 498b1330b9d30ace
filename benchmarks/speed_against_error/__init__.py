"""Speed against error: what each number that ncgear reports costs, by the methods that could compute it."""
