"""Learning from captures: the network of Taylor et al. 2017, the phone bigrams of Xu et al. 2013."""
