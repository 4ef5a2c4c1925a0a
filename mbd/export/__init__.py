"""Results for other programs: labelled arrays, tables, text files, ParaView. Nothing else in the library imports this."""
