"""What is kept: plan, pipeline, files, versions, verification and loaders."""
