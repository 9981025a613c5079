"""Datasets of somebody who knows the format and means harm, everything that reads one, and a campaign of both."""
