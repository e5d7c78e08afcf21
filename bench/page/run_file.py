"""The file by which a result folder is known."""

RUN_FILE = "report.json"
