"""What is done with an answer: documents, tables, exports, pictures and pages."""
