// What reads images, as part of the program: libFuzzer is to see its code, and no fuzzer is without it.
#include "runtime/io/picture_library.h"

extern "C" const gradus::PictureLibrary gradus_picture_library;

namespace gradus {

const PictureLibrary &picture_library() { return gradus_picture_library; }

} // namespace gradus
