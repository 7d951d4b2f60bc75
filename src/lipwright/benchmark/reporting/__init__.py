"""The report of a benchmark: JSON and CSV for programs, a page and Markdown for people, videos."""

from lipwright.benchmark.reporting.tables import markdown_tables
from lipwright.benchmark.reporting.videos import RealMouth, write_video
from lipwright.benchmark.reporting.write import write_report

__all__ = ["RealMouth", "markdown_tables", "write_report", "write_video"]
