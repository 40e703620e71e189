#include "runtime/device/program_image.h"

#include "runtime/device/byte_text.h"

namespace gradus {

std::string to_bytes(const ProgramImage &image) {
    ByteWriter writer;
    writer.number(image.kernels.size());
    for (const auto &[kernel, arguments] : image.kernels) {
        writer.text(kernel);
        writer.number(arguments.size());
        for (const KernelArgument &argument : arguments) {
            writer.text(argument.name);
            writer.text(argument.type);
        }
    }
    writer.text(image.binary);
    return writer.bytes();
}

ProgramImage program_image(std::string_view bytes) {
    ByteReader reader(bytes);
    ProgramImage image;
    for (std::uint64_t kernels = reader.number(); kernels > 0; --kernels) {
        std::vector<KernelArgument> &arguments = image.kernels[std::string(reader.text())];
        for (std::uint64_t count = reader.number(); count > 0; --count) {
            const std::string_view name = reader.text();
            arguments.push_back({std::string(name), std::string(reader.text())});
        }
    }
    image.binary = reader.text();
    if (!reader.rest().empty())
        throw std::runtime_error("a program's record is longer than it says");
    return image;
}

} // namespace gradus
