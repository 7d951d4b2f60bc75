"""`python -m lipwright`."""

from lipwright.cli import main

main()
