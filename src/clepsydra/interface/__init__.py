"""The public interface: what `import clepsydra as cl` publishes and the command line uses."""
