"""What notebooks show of a drive and of its stages: figures in the report's words, charts, the machine running."""
