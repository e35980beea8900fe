"""What a report needs to run its loops again while its reader moves their settings."""
