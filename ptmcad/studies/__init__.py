"""What uses the program as a user would: the paper reproduced, error against run time, stress."""
