"""The report: a page with the running mechanism, its curves, its figures, and the versions of the programs."""

REPORT_FILE = "report.html"
