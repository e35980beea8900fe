"""The lessons that come with Clepsydra, a file each, and the processes that only they have."""
