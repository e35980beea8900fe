"""The vendors' PID blocks, a vendor a file, each with the documents its facts are from."""
