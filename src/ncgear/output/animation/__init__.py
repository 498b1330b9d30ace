"""The scene as a moving picture: frames drawn by matplotlib, packed as GIF or MP4."""
