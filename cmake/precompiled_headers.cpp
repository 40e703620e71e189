// A library needs a source: the headers that it compiles for others are named in CMakeLists.txt.
