#include "runtime/pictures/picture_input.h"

#include "runtime/io/image_checks.h"

#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace gradus {
namespace {

/// OpenImageIO's names of them. The last has no mark in its files, so it is tried last.
const std::vector<std::string> formats_of_one_file = {"openexr", "png", "jpeg", "tiff",     "hdr", "bmp", "pnm",
                                                      "webp",    "gif", "dds",  "jpeg2000", "psd", "sgi", "targa"};

/// The readers to try, in turn: first that of the name's extension.
std::vector<std::unique_ptr<OIIO::ImageInput>> readers_for(const OpenFile &file) {
    std::vector<std::unique_ptr<OIIO::ImageInput>> readers;
    const std::string extension = OIIO::Strutil::lower(file.name().extension().string());
    if (extension.size() > 1)
        if (auto reader = OIIO::ImageInput::create(extension.substr(1)))
            readers.push_back(std::move(reader));
    OIIO::geterror(); // of an extension that nobody knows
    const auto opens_others = [](const std::unique_ptr<OIIO::ImageInput> &reader) {
        return std::find(formats_of_one_file.begin(), formats_of_one_file.end(), reader->format_name()) ==
               formats_of_one_file.end();
    };
    readers.erase(std::remove_if(readers.begin(), readers.end(), opens_others), readers.end());
    for (const std::string &format : formats_of_one_file)
        if (readers.empty() || readers.front()->format_name() != format)
            if (auto reader = OIIO::ImageInput::create(format))
                readers.push_back(std::move(reader));
    return readers;
}

/// One that is refused has an error. Radiance's files may have their rows in eight orders, which OpenImageIO tells, and
/// leaves as they are.
PictureInput checked(PictureInput opened) {
    if (opened.input && std::string_view(opened.input->format_name()) == "hdr" &&
        opened.input->spec().get_int_attribute("Orientation", 1) != 1)
        return {nullptr, "its rows do not run from the top left (a resolution of -Y height +X width)"};
    return opened;
}

} // namespace

PictureInput open_picture(const OpenFile &file) {
    OIIO::ImageSpec wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1);
    PictureInput opened;
    // Of a name with a question mark OpenImageIO takes what follows it for parameters; readers themselves do not.
    if (!file.is_confined() && file.library_name().find('?') == std::string::npos) {
        opened.input = OIIO::ImageInput::open(file.library_name(), &wishes);
        if (!opened.input)
            opened.error = OIIO::geterror();
        return checked(std::move(opened));
    }
    for (std::unique_ptr<OIIO::ImageInput> &reader : readers_for(file)) {
        OIIO::ImageSpec spec;
        if (reader->open(file.library_name(), spec, wishes)) {
            opened.input = std::move(reader);
            return checked(std::move(opened));
        }
        const std::string error = reader->geterror();
        if (opened.error.empty())
            opened.error = named_in(error, file);
    }
    opened.error += std::string("; ") + (file.is_confined() ? "with --confined" : "of a name with a question mark") +
                    " the formats are " + OIIO::Strutil::join(formats_of_one_file, ", ");
    return opened;
}

} // namespace gradus
