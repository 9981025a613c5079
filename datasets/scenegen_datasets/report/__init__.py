"""The report: a dataset on one page that needs no other file."""
