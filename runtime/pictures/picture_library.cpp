// What the library offers to those that load it.
#include "runtime/io/picture_library.h"

#include "runtime/pictures/bitmap_decoder.h"
#include "runtime/pictures/image_codec.h"
#include "runtime/version.h"

extern "C" const gradus::PictureLibrary gradus_picture_library = {GRADUS_VERSION, gradus::decode_image,
                                                                  gradus::decode_bitmap, gradus::encode_png};
