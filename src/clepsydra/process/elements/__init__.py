"""The elements of plants, one a file; a file that is added here is known to process files."""
