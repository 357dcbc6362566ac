"""The exact engine: from a `Slice` to a `RegionMap`, poses or ranges, by algebra."""
