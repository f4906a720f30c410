"""Linear least squares over moving data: what named causes have to predict at least as well."""
