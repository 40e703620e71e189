# OpenImageIO::OpenImageIO. OpenImageIO has a configuration of its own, but Debian's fails unless the image viewer
# (with Qt) and the Python module of Imath are installed too, and names OpenCV's folder, installed or not.
find_path(OpenImageIO_INCLUDE_DIR OpenImageIO/imageio.h)
find_library(OpenImageIO_LIBRARY OpenImageIO)
find_library(OpenImageIO_Util_LIBRARY OpenImageIO_Util)
mark_as_advanced(OpenImageIO_INCLUDE_DIR OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY)

if(OpenImageIO_INCLUDE_DIR)
  file(STRINGS ${OpenImageIO_INCLUDE_DIR}/OpenImageIO/oiioversion.h lines
       REGEX "^#define OIIO_VERSION_(MAJOR|MINOR|PATCH) +[0-9]+")
  string(REGEX MATCHALL "[0-9]+" numbers "${lines}")
  list(JOIN numbers "." OpenImageIO_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO
  REQUIRED_VARS OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY OpenImageIO_INCLUDE_DIR
  VERSION_VAR OpenImageIO_VERSION)

if(OpenImageIO_FOUND AND NOT TARGET OpenImageIO::OpenImageIO)
  add_library(OpenImageIO::OpenImageIO UNKNOWN IMPORTED)
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
    IMPORTED_LOCATION ${OpenImageIO_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OpenImageIO_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES ${OpenImageIO_Util_LIBRARY})
endif()
