"""Training of the sliding-window network: Taylor et al. 2017, section 5; the thesis, chapter 4."""
