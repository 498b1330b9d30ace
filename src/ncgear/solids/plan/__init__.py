"""A gear's body as a workshop describes it, before it is a mesh or a solid of faces."""
