"""The door of OPC UA: the tags of a rig for its clients, and the rig as a client of a PLC."""
