// The source of a target that is its precompiled headers alone.
