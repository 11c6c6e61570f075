"""One writer for reports: tables, figures and sentences as JSON, CSV, PNG, Markdown and HTML."""
