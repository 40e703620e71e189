// Mitsuba's serialized meshes. A file is a row of meshes and, at its end, the table of their offsets and their count
// (32 bits). A mesh is the bytes 1C 04, its version (16 bits), and a zlib stream of flags, [from version 4: a name],
// counts, positions, normals, texture coordinates, colours and triangles. All little endian.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <limits>

namespace gradus {

namespace {

constexpr std::uint16_t format_mark = 0x041c;
const std::string vertex_color = "vertex_color";
constexpr std::size_t piece = 1 << 16; ///< of numbers or triangles that are inflated at a time
enum Flags : std::uint32_t {
    has_normals = 0x0001,
    has_texcoords = 0x0002,
    has_colors = 0x0008,
    wants_face_normals = 0x0010,
    double_precision = 0x2000 // neither 0x1000 nor this: single precision
};

template <typename T>
T little_endian(const unsigned char *bytes) {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        value |= T(T(bytes[i]) << (8 * i));
    return value;
}

/// Inflates a zlib stream piece by piece.
class Inflater {
  public:
    Inflater(const char *begin, std::size_t size) {
        stream_.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(begin));
        stream_.avail_in = uInt(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
        ready_ = inflateInit(&stream_) == Z_OK;
    }
    ~Inflater() {
        if (ready_)
            inflateEnd(&stream_);
    }
    Inflater(const Inflater &) = delete;
    Inflater &operator=(const Inflater &) = delete;

    /// False where the stream is broken or ends first.
    bool read(void *target, std::size_t size) {
        auto *at = static_cast<Bytef *>(target);
        while (ready_ && size > 0) {
            const std::size_t piece = std::min<std::size_t>(size, 1u << 30);
            stream_.next_out = at;
            stream_.avail_out = uInt(piece);
            const int status = inflate(&stream_, Z_NO_FLUSH);
            const std::size_t got = piece - stream_.avail_out;
            at += got;
            size -= got;
            if (size > 0 && (status != Z_OK || got == 0))
                return false;
        }
        return ready_;
    }

  private:
    z_stream stream_{};
    bool ready_ = false;
};

class SerializedReader {
  public:
    SerializedReader(const std::string &data, const std::string &file_name, std::uint64_t index,
                     const LoadLimits &limits, bool keeps_colors)
        : data_(data), file_name_(file_name), index_(index), limits_(limits), keeps_colors_(keeps_colors) {}

    SerializedMesh read();

  private:
    [[noreturn]] void fail(const std::string &message) const {
        throw SceneError({std::make_shared<const std::string>(file_name_), 0}, message);
    }
    const unsigned char *bytes(std::uint64_t offset) const {
        return reinterpret_cast<const unsigned char *>(data_.data()) + offset;
    }
    std::pair<std::uint64_t, std::uint64_t> find_mesh(std::uint16_t version) const;
    void read_bytes(Inflater &inflater, void *target, std::size_t size) const {
        if (!inflater.read(target, size))
            fail("mesh " + std::to_string(index_) + " is truncated or corrupt");
    }
    std::uint64_t read_count(Inflater &inflater, std::uint64_t most) const;
    /// So many numbers, one after the other.
    void read_floats(Inflater &inflater, std::uint64_t count, bool doubles, float *to) const;
    /// All of the mesh.
    void read_triangles(Inflater &inflater, std::size_t vertices, Mesh &mesh) const;

    const std::string &data_;
    const std::string &file_name_;
    std::uint64_t index_;
    const LoadLimits limits_;
    const bool keeps_colors_;
};

/// Where the mesh begins and ends. The end is the next offset or the table.
std::pair<std::uint64_t, std::uint64_t> SerializedReader::find_mesh(std::uint16_t version) const {
    const std::uint64_t size = data_.size(), entry = version == 3 ? 4 : 8;
    const std::uint64_t count = little_endian<std::uint32_t>(bytes(size - 4));
    if (count == 0 || count > (size - 4) / entry)
        fail("corrupt: the file ends with a count of " + std::to_string(count) + " meshes");
    if (index_ >= count)
        fail("there is no mesh " + std::to_string(index_) + "; the file holds " + std::to_string(count) +
             ", counted from 0");
    const std::uint64_t table = size - 4 - count * entry;
    const auto offset = [&](std::uint64_t i) {
        return version == 3 ? std::uint64_t(little_endian<std::uint32_t>(bytes(table + i * entry)))
                            : little_endian<std::uint64_t>(bytes(table + i * entry));
    };
    const std::uint64_t begin = offset(index_);
    if (begin > table || table - begin < 4)
        fail("corrupt: the offset of mesh " + std::to_string(index_) + " lies outside the file");
    const std::uint64_t next = index_ + 1 < count ? offset(index_ + 1) : table;
    return {begin, next > begin && next <= table ? next : table};
}

std::uint64_t SerializedReader::read_count(Inflater &inflater, std::uint64_t most) const {
    unsigned char raw[8];
    read_bytes(inflater, raw, sizeof raw);
    const std::uint64_t count = little_endian<std::uint64_t>(raw);
    if (count > most)
        fail("corrupt: mesh " + std::to_string(index_) + " claims " + std::to_string(count) + " elements");
    return count;
}

void SerializedReader::read_floats(Inflater &inflater, std::uint64_t count, bool doubles, float *to) const {
    const std::size_t width = doubles ? 8 : 4;
    std::vector<unsigned char> raw(piece * width);
    while (count > 0) {
        const std::uint64_t now = std::min<std::uint64_t>(piece, count);
        read_bytes(inflater, raw.data(), now * width);
        for (std::uint64_t i = 0; i < now; ++i)
            *to++ = doubles ? float(std::bit_cast<double>(little_endian<std::uint64_t>(&raw[i * 8])))
                            : std::bit_cast<float>(little_endian<std::uint32_t>(&raw[i * 4]));
        count -= now;
    }
}

void SerializedReader::read_triangles(Inflater &inflater, std::size_t vertices, Mesh &mesh) const {
    std::vector<unsigned char> raw(piece * sizeof(mesh.triangles[0]));
    for (std::size_t begin = 0; begin < mesh.triangles.size(); begin += piece) {
        const std::size_t end = std::min(begin + piece, mesh.triangles.size());
        read_bytes(inflater, raw.data(), (end - begin) * sizeof(mesh.triangles[0]));
        const unsigned char *corner = raw.data();
        for (std::size_t i = begin; i < end; ++i)
            for (std::uint32_t &index : mesh.triangles[i]) {
                index = little_endian<std::uint32_t>(corner);
                corner += 4;
                if (index >= vertices)
                    fail("corrupt: a triangle of mesh " + std::to_string(index_) + " has vertex " +
                         std::to_string(index) + " of " + std::to_string(vertices));
            }
    }
}

SerializedMesh SerializedReader::read() {
    if (data_.size() < 12)
        fail("not a serialized mesh file: only " + std::to_string(data_.size()) + " bytes");
    if (little_endian<std::uint16_t>(bytes(0)) != format_mark)
        fail("not a serialized mesh file: it does not begin with 1C 04");
    const auto file_version = little_endian<std::uint16_t>(bytes(2));
    if (file_version != 3 && file_version != 4)
        fail("serialized format version " + std::to_string(file_version) + " is not known (known: 3, 4)");
    const auto [begin, end] = find_mesh(file_version);
    const auto version = little_endian<std::uint16_t>(bytes(begin + 2));
    if (little_endian<std::uint16_t>(bytes(begin)) != format_mark || (version != 3 && version != 4))
        fail("corrupt: mesh " + std::to_string(index_) + " does not begin with 1C 04 and a known version");

    Inflater inflater(data_.data() + begin + 4, end - begin - 4);
    unsigned char raw[4];
    read_bytes(inflater, raw, 4);
    const auto flags = little_endian<std::uint32_t>(raw);
    if (version == 4) { // the name
        constexpr int longest = 4096;
        int length = 0;
        for (char c = 1; c != 0; ++length) {
            if (length > longest)
                fail("corrupt: the name of mesh " + std::to_string(index_) + " has no end");
            read_bytes(inflater, &c, 1);
        }
    }
    // Deflate shrinks by 1032 at most, which bounds what a stream can hold.
    const std::uint64_t most = (end - begin) * 1032 / 12 + 1;
    const std::uint64_t vertices = read_count(inflater, std::min<std::uint64_t>(most, 0x7fffffff));
    const std::uint64_t triangles = read_count(inflater, most);

    const bool doubles = flags & double_precision;
    const std::uint64_t numbers = 3 + (flags & has_normals ? 3 : 0) + (flags & has_texcoords ? 2 : 0) +
                                  (flags & has_colors ? 3 : 0); // of a vertex
    const std::uint64_t unfolded = vertices * numbers * (doubles ? 8 : 4) + triangles * 12;
    // The least that numbers shrink in practice is to a third; a plane of a million equal ones is another matter.
    if (unfolded > std::max(limits_.unfolded_bytes, (end - begin) * limits_.unfolding))
        fail("mesh " + std::to_string(index_) + " unfolds to " + std::to_string(unfolded >> 20) + " MiB, " +
             std::to_string(limits_.unfolding) + " times its size and more" + limits_hint);
    SerializedMesh result;
    result.unfolded_bytes = unfolded;
    result.face_normals = flags & wants_face_normals;
    // What the counts ask for is bounded by now, so it can be taken before the data arrives.
    Mesh &mesh = result.mesh;
    const auto read_vectors = [&](std::vector<Vector3> &vectors) {
        vectors.resize(vertices);
        if (vertices > 0)
            read_floats(inflater, vertices * 3, doubles, &vectors[0].x);
    };
    read_vectors(mesh.positions);
    if (flags & has_normals)
        read_vectors(mesh.normals);
    if (flags & has_texcoords) {
        mesh.texcoords.resize(vertices);
        if (vertices > 0)
            read_floats(inflater, vertices * 2, doubles, mesh.texcoords[0].data());
    }
    if (flags & has_colors) {
        std::vector<float> colors(vertices * 3);
        read_floats(inflater, vertices * 3, doubles, colors.data());
        if (keeps_colors_)
            mesh.attributes.push_back({vertex_color, 3, std::move(colors)});
    }
    mesh.triangles.resize(triangles);
    read_triangles(inflater, vertices, mesh);
    return result;
}

} // namespace

SerializedMesh parse_serialized(const std::string &data, const std::string &file_name, std::uint64_t index,
                                const LoadLimits &limits, const std::vector<std::string> &attributes) {
    const bool keeps_colors = std::ranges::count(attributes, vertex_color) > 0;
    return SerializedReader(data, file_name, index, limits, keeps_colors).read();
}

} // namespace gradus
