"""Small models of one channel, and what the tuning rules need of them."""
