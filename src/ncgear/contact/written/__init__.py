"""Contact of the outlines as files hold them."""
