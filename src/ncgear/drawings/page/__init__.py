"""The report: one page with the running mechanism, its curves, its figures, and the versions that made it."""

REPORT_FILE = "report.html"
