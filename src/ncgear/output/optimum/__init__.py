"""What ``ncgear optimize`` and ``ncgear frontier`` hand over."""
