"""`python -m lipwright.cli`."""

from lipwright.cli import main

main()
