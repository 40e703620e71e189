# Writes OUTPUT, a C++ file that holds the text of each of FILES (paths relative to ROOT).
set(text "// Made by cmake/embed_kernels.cmake.\n#include \"runtime/device/embedded_kernels.h\"\n\nnamespace gradus {\n")
string(APPEND text "const std::vector<EmbeddedKernel> &embedded_kernels() {\n    static const std::vector<EmbeddedKernel> files = {\n")
foreach(file IN LISTS FILES)
  file(READ ${ROOT}/${file} content)
  string(APPEND text "        {\"${file}\", R\"gradus_kernel(${content})gradus_kernel\"},\n")
endforeach()
string(APPEND text "    };\n    return files;\n}\n} // namespace gradus\n")
file(WRITE ${OUTPUT} "${text}")
