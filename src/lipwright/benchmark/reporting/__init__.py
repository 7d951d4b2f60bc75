"""The report of a benchmark: JSON and CSV for programs, a page and Markdown for people, videos."""

from lipwright.benchmark.reporting.markdown import markdown_tables
from lipwright.benchmark.reporting.mouths import RealMouth, real_mouth
from lipwright.benchmark.reporting.videos import write_video
from lipwright.benchmark.reporting.write import write_report

__all__ = ["RealMouth", "markdown_tables", "real_mouth", "write_report", "write_video"]
