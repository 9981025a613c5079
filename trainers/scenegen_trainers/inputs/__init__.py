"""From a dataset's counts and metres to what a network reads and is asked for."""
