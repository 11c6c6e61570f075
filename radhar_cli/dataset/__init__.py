"""Many scenes -> shards -> dataset.h5 and PNG files; resume, verify, estimate."""
