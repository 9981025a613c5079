"""The viewer: a page on this machine that shows a dataset frame by frame, with numbers under the cursor."""
