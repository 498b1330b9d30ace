"""The report: one page that shows the mechanism running, its curves, its figures and what made it."""

REPORT_FILE = "report.html"
