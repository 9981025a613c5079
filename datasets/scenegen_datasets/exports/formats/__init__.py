"""One file per format. A format reads `scenegen_datasets.exports.clip.Clip` and writes to a `Stage`; see `registry`."""
