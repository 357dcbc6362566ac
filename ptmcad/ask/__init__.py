"""What a user calls: it chooses the engine, and asks what is known already of a result."""
