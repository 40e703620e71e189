// Writes small mesh files for tests, byte by byte as their formats have it.
#pragma once

#include "runtime/scene/scene.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace gradus {

template <typename T>
void append_bytes(std::string &data, T value, bool big_endian = false) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (big_endian)
        std::reverse(bytes, bytes + sizeof(T));
    data.append(bytes, sizeof(T));
}

/// Two triangles that share an edge and do not lie in one plane, with normals and texture coordinates of no meaning.
inline Mesh folded_square() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5f}};
    mesh.normals = {{0, 0, 1}, {0, 0.6f, 0.8f}, {0.6f, 0, 0.8f}, {0, 0, 1}};
    mesh.texcoords = {{0, 0}, {1, 0.25f}, {1, 1}, {0, 0.75f}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

inline std::string deflated(const std::string &data) {
    std::string result(compressBound(data.size()), '\0');
    uLongf size = result.size();
    compress(reinterpret_cast<Bytef *>(result.data()), &size, reinterpret_cast<const Bytef *>(data.data()),
             data.size());
    result.resize(size);
    return result;
}

struct SerializedOptions {
    std::uint16_t version = 4;
    std::uint32_t precision = 0x1000; ///< 0x1000 single, 0x2000 double, 0 neither
    bool colors = false, face_normals = false;
};

/// The contents of one mesh before compression.
inline std::string serialized_payload(const Mesh &mesh, const SerializedOptions &options) {
    std::string data;
    append_bytes<std::uint32_t>(data, options.precision | (mesh.normals.empty() ? 0 : 1) |
                                          (mesh.texcoords.empty() ? 0 : 2) | (options.colors ? 8 : 0) |
                                          (options.face_normals ? 16 : 0));
    if (options.version == 4)
        data += std::string("a name\0", 7);
    append_bytes<std::uint64_t>(data, mesh.positions.size());
    append_bytes<std::uint64_t>(data, mesh.triangles.size());
    const auto number = [&](float value) {
        if (options.precision == 0x2000)
            append_bytes<double>(data, value);
        else
            append_bytes<float>(data, value);
    };
    for (const auto *vectors : {&mesh.positions, &mesh.normals})
        for (const Vector3 &v : *vectors)
            for (float value : {v.x, v.y, v.z})
                number(value);
    for (const auto &[u, v] : mesh.texcoords) {
        number(u);
        number(v);
    }
    if (options.colors)
        for (std::size_t i = 0; i < 3 * mesh.positions.size(); ++i)
            number(0.5f);
    for (const auto &triangle : mesh.triangles)
        for (std::uint32_t index : triangle)
            append_bytes(data, index);
    return data;
}

inline std::string serialized_file(const std::vector<Mesh> &meshes, const SerializedOptions &options) {
    std::string file;
    std::vector<std::uint64_t> offsets;
    for (const Mesh &mesh : meshes) {
        offsets.push_back(file.size());
        append_bytes<std::uint16_t>(file, 0x041c);
        append_bytes(file, options.version);
        file += deflated(serialized_payload(mesh, options));
    }
    for (std::uint64_t offset : offsets)
        if (options.version == 3)
            append_bytes(file, std::uint32_t(offset));
        else
            append_bytes(file, offset);
    append_bytes(file, std::uint32_t(meshes.size()));
    return file;
}

/// A binary PLY with properties and elements that a reader must skip.
inline std::string binary_ply(const Mesh &mesh, bool big_endian) {
    std::string file =
        "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
        "_endian 1.0\ncomment by a test\nelement vertex " + std::to_string(mesh.positions.size()) +
        "\nproperty uchar red\nproperty double x\nproperty float y\nproperty float z\nproperty list "
        "uchar short weights\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float "
        "s\nproperty float t\nelement edge 2\nproperty int a\nproperty list uchar float b\nelement face " +
        std::to_string(mesh.triangles.size()) +
        "\nproperty float quality\nproperty list uchar uint vertex_indices\nproperty ushort "
        "group\nend_header\n";
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        append_bytes<std::uint8_t>(file, 77);
        append_bytes<double>(file, mesh.positions[i].x, big_endian);
        append_bytes(file, mesh.positions[i].y, big_endian);
        append_bytes(file, mesh.positions[i].z, big_endian);
        append_bytes<std::uint8_t>(file, std::uint8_t(i)); // a list as long as the vertex's number
        for (std::size_t j = 0; j < i; ++j)
            append_bytes<std::int16_t>(file, -5, big_endian);
        for (float value :
             {mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z, mesh.texcoords[i][0], mesh.texcoords[i][1]})
            append_bytes(file, value, big_endian);
    }
    for (int i = 0; i < 2; ++i) {
        append_bytes<std::int32_t>(file, 9, big_endian);
        append_bytes<std::uint8_t>(file, 1);
        append_bytes<float>(file, 3, big_endian);
    }
    for (const auto &triangle : mesh.triangles) {
        append_bytes<float>(file, 1, big_endian);
        append_bytes<std::uint8_t>(file, 3);
        for (std::uint32_t index : triangle)
            append_bytes(file, index, big_endian);
        append_bytes<std::uint16_t>(file, 4, big_endian);
    }
    return file;
}

} // namespace gradus
