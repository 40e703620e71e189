// A library needs a source: the headers that it compiles for all tests are named in CMakeLists.txt.
