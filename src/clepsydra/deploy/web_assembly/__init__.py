"""WebAssembly of controllers and processes, with the JavaScript that calls it by names."""
