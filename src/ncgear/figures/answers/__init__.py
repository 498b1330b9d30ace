"""What each command answers on one screen."""
