"""Areas of regions: walls integrated on panels, with proved errors."""
