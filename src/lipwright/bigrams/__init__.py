"""Phone bigrams (Xu et al. 2013): curves that an animator draws for pairs of adjacent phones."""
