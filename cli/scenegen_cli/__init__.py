"""The front door: the `scenegen` command, one file per subcommand."""
