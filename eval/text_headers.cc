// The source of alidade_text_headers, which is its precompiled headers alone.
