"""Modbus TCP: a rig as a server, a master of it, and a rig as the client of a PLC."""
