"""The report: one page that shows the mechanism at work."""
