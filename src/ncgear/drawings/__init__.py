"""What is drawn: plots, the scene, the animation, the page."""
