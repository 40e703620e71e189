// Spectra in files of their own.
#pragma once

#include <optional>
#include <string>

namespace gradus {

/// "wavelength:value, ..." of a file that has a wavelength in nm and a value on each line, as those that end in .spd;
/// lines that are empty or begin with # count for nothing. Nothing where it is no such file.
std::optional<std::string> spectrum_of_file(const std::string &text);

} // namespace gradus
