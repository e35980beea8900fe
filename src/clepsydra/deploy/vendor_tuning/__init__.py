"""The tuning of PID loops in the forms and units of the common vendors' own blocks."""
