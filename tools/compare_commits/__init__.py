"""What the command line prints and writes at two commits, and where it differs.

`python tools/compare_commits OLD NEW` runs every verb on the whole catalogue at both.
"""
