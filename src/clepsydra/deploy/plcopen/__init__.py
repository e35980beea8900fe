"""PLCopen XML: function blocks and test projects for the editors of PLC systems."""
