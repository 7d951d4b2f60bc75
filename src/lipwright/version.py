"""The version, as the package was built."""

from importlib.metadata import PackageNotFoundError, version

try:
    VERSION = version("lipwright")
except PackageNotFoundError:  # run from a source tree that is not installed
    VERSION = "0+unknown"
