"""Within what a level has settled, where a document does not print it: decision 14."""

#: Both that are usual, the narrower first [share of a step].
BANDS = (0.02, 0.05)
