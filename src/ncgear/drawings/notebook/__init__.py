"""The view of a drive and its stages in notebooks: figures in the report's words, charts, the running machine."""
