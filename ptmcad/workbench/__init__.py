"""What stands on the core and is imported by it nowhere: sweeps, designs, families, fields and
films, and the page on which one explores.
"""
