"""HTML pages in one style: text, tables, charts and pictures, in one file that needs no other, by day and by night."""
