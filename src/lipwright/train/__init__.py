"""Learning from captures: networks (Taylor et al. 2017) and phone bigrams (Xu et al. 2013)."""
