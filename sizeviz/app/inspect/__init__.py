"""Looking closely: the element under the cursor, the worst ones, histograms, the table of both methods."""
