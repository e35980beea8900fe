"""Doors of a rig: Modbus TCP, OPC UA, and the page of its operator."""
