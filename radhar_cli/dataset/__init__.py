"""Many scenes as a data set: rows are made in batches, kept in shards, assembled into dataset.h5.

A sample is the stored products of one scene (`sample.StoredSample`). A row is a sample with the
numbers of its scene and its warnings (`sample.SampleRow`). A batch is the rows that a worker makes
at a time (`batch.Batch`), a shard the file that keeps them (`shards.Shard`). A part is what
`generate --shard` makes, and `merge` puts together (`parts.DataSetPart`).
"""
