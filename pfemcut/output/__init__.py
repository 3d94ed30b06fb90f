"""What a run shows: fields for ParaView, pictures, the report and the progress display."""
