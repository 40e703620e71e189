// PLY, the Stanford polygon format: a text header that lists elements and their properties, then their values.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "runtime/io/ply_attributes.h"
#include "runtime/io/ply_corner_texcoords.h"
#include "runtime/io/text.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace gradus {

namespace {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Scalar> scalar_type(std::string_view name) {
    if (name == "char" || name == "int8")
        return Scalar::int8;
    if (name == "uchar" || name == "uint8")
        return Scalar::uint8;
    if (name == "short" || name == "int16")
        return Scalar::int16;
    if (name == "ushort" || name == "uint16")
        return Scalar::uint16;
    if (name == "int" || name == "int32")
        return Scalar::int32;
    if (name == "uint" || name == "uint32")
        return Scalar::uint32;
    if (name == "float" || name == "float32")
        return Scalar::float32;
    if (name == "double" || name == "float64")
        return Scalar::float64;
    return std::nullopt;
}

std::size_t size_of(Scalar type) {
    constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[int(type)];
}

struct Property {
    std::string name;
    Scalar type = Scalar::float32;
    std::optional<Scalar> count_type; // a list where it has one
};

struct ElementDeclaration {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    /// Bytes of one in a binary file at least, or characters in ASCII.
    std::uint64_t least_size(bool ascii) const {
        std::uint64_t size = 0;
        for (const Property &property : properties)
            size += ascii ? 2 : size_of(property.count_type.value_or(property.type));
        return std::max<std::uint64_t>(size, 1);
    }
};

template <typename T>
T load(const char *at, bool swap) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, at, sizeof(T));
    if (swap)
        std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

double load_scalar(const char *at, Scalar type, bool swap) {
    switch (type) {
    case Scalar::int8:
        return load<std::int8_t>(at, swap);
    case Scalar::uint8:
        return load<std::uint8_t>(at, swap);
    case Scalar::int16:
        return load<std::int16_t>(at, swap);
    case Scalar::uint16:
        return load<std::uint16_t>(at, swap);
    case Scalar::int32:
        return load<std::int32_t>(at, swap);
    case Scalar::uint32:
        return load<std::uint32_t>(at, swap);
    case Scalar::float32:
        return load<float>(at, swap);
    case Scalar::float64:
        return load<double>(at, swap);
    }
    return 0;
}

constexpr std::size_t most_elements = 1000; // kinds of them; files have two or three
using Tasks = tbb::blocked_range<std::size_t>;
constexpr std::size_t vertices_a_task = 1 << 14;

bool is_index(const std::string &property) { return property == "vertex_indices" || property == "vertex_index"; }
/// As MeshLab writes them: u and v of each corner.
bool is_corner_texcoords(const Property &property) { return property.count_type && property.name == "texcoord"; }

class PlyReader {
  public:
    PlyReader(const std::string &data, const std::string &file_name, const std::vector<std::string> &wanted)
        : at_(data.data()), end_(data.data() + data.size()), file_name_(file_name), wanted_(wanted) {}

    Mesh read() {
        read_header();
        for (const ElementDeclaration &element : elements_) {
            if (element.name == "face" && element.count > 0)
                check_indices_are_there(element);
            if (element.properties.empty()) // none takes a byte, however many there are said to be
                continue;
            if (element.count > std::uint64_t(end_ - at_) / element.least_size(ascii_) + 1)
                fail("truncated: " + std::to_string(element.count) + " of \"" + element.name +
                     "\" are announced, more than the file holds");
            if (element.name == "vertex")
                read_vertices(element);
            else if (element.name == "face")
                read_faces(element);
            else
                for (std::uint64_t i = 0; i < element.count; ++i)
                    for (const Property &property : element.properties)
                        skip(property);
        }
        if (!mesh_.positions.empty() &&
            std::ranges::find(elements_, "face", &ElementDeclaration::name) == elements_.end())
            fail_without_faces();
        for (const auto &triangle : mesh_.triangles)
            for (std::uint32_t index : triangle)
                if (index >= mesh_.positions.size())
                    fail("face index " + std::to_string(index) + " is out of range: there are " +
                         std::to_string(mesh_.positions.size()) + " vertices");
        if (!corner_texcoords_.empty()) {
            if (mesh_.positions.size() + corner_texcoords_.size() > std::numeric_limits<std::int32_t>::max())
                fail("more corners with texture coordinates than 32-bit indices hold");
            set_corner_texcoords(mesh_, corner_texcoords_);
        }
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string &message) const {
        throw SceneError({std::make_shared<const std::string>(file_name_), line_}, message);
    }
    [[noreturn]] void fail_without_faces() const;
    void check_indices_are_there(const ElementDeclaration &faces) const;
    std::string_view header_line();
    void read_header();
    double value(Scalar type);
    std::uint64_t list_length(const Property &property);
    void skip(const Property &property);
    void read_vertices(const ElementDeclaration &element);
    void read_faces(const ElementDeclaration &element);
    bool read_triangles(const ElementDeclaration &element);
    void add_polygon(std::vector<std::uint32_t> &polygon, std::vector<float> *texcoords);
    std::vector<PlyAttribute> attributes_of(const ElementDeclaration &element, const char *prefix);

    const char *at_, *const end_;
    const std::string &file_name_;
    const std::vector<std::string> &wanted_; // attributes
    std::size_t line_ = 0;                   // counted in the header alone; 0 after it
    bool ascii_ = false, swap_ = false, has_vertices_ = false;
    std::vector<ElementDeclaration> elements_;
    std::vector<std::array<float, 2>> corner_texcoords_; // three for each triangle; empty: faces have none
    Mesh mesh_;
};

void PlyReader::fail_without_faces() const {
    std::vector<std::string> skipped;
    for (const ElementDeclaration &element : elements_)
        if (element.name != "vertex")
            skipped.push_back(fmt::format("\"{}\"", element.name));
    fail(fmt::format("the file has vertices but no element \"face\"{}{}",
                     skipped.empty() ? "" : "; not read: ", shortened(join(skipped), 80)));
}

void PlyReader::check_indices_are_there(const ElementDeclaration &faces) const {
    std::vector<std::string> others;
    for (const Property &property : faces.properties) {
        if (property.count_type && is_index(property.name))
            return;
        others.push_back(fmt::format("\"{}\"", property.name));
    }
    fail(fmt::format("the faces have no property list \"vertex_indices\" or \"vertex_index\"{}{}",
                     others.empty() ? "" : "; not read: ", shortened(join(others), 80)));
}

std::string_view PlyReader::header_line() {
    ++line_;
    const char *begin = at_;
    while (at_ < end_ && *at_ != '\n')
        ++at_;
    if (at_ == end_)
        fail("the header has no end_header");
    std::string_view line(begin, std::size_t(at_ - begin));
    ++at_;
    return trimmed(line);
}

void PlyReader::read_header() {
    if (end_ - at_ < 4 || std::string_view(at_, 3) != "ply")
        fail("not a PLY file: it does not begin with \"ply\"");
    header_line();
    bool has_format = false;
    for (;;) {
        const std::string_view line = header_line();
        const std::vector<std::string_view> words = split_list(line);
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info")
            continue;
        if (words[0] == "end_header")
            break;
        if (words[0] == "format" && words.size() >= 2) {
            has_format = true;
            const bool little = words[1] == "binary_little_endian", big = words[1] == "binary_big_endian";
            ascii_ = words[1] == "ascii";
            if (!ascii_ && !little && !big)
                fail("unknown PLY format \"" + std::string(words[1]) + "\"");
            swap_ = !ascii_ && little != (std::endian::native == std::endian::little);
        } else if (words[0] == "element" && words.size() == 3) {
            const std::optional<std::int64_t> count = parse_integer(words[2]);
            if (!count || *count < 0)
                fail("\"" + std::string(words[2]) + "\" is no count of elements");
            for (const char *name : {"vertex", "face"}) // their properties are said once for all
                if (words[1] == name &&
                    std::any_of(elements_.begin(), elements_.end(),
                                [&](const ElementDeclaration &other) { return other.name == name; }))
                    fail(std::string("a second element \"") + name + "\"");
            if (elements_.size() >= most_elements)
                fail("more than " + std::to_string(most_elements) + " elements are declared");
            has_vertices_ |= words[1] == "vertex" && *count > 0;
            elements_.push_back({std::string(words[1]), std::uint64_t(*count), {}});
        } else if (words[0] == "property" && !elements_.empty() && words.size() >= 3) {
            Property property;
            property.name = words.back();
            const bool is_list = words[1] == "list" && words.size() == 5;
            const std::optional<Scalar> type = scalar_type(words[is_list ? 3 : 1]);
            if (is_list)
                property.count_type = scalar_type(words[2]);
            if (!type || (is_list && !property.count_type))
                fail("unknown property type in \"" + shortened(line, 80) + "\"");
            property.type = *type;
            elements_.back().properties.push_back(property);
        } else
            fail("cannot read the header line \"" + shortened(line, 80) + "\"");
    }
    if (!has_format)
        fail("the header has no format line");
    line_ = 0;
}

double PlyReader::value(Scalar type) {
    if (!ascii_) {
        const std::size_t size = size_of(type);
        if (std::size_t(end_ - at_) < size)
            fail("truncated: the file ends before its last element");
        const double result = load_scalar(at_, type, swap_);
        at_ += size;
        return result;
    }
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t'))
        ++at_;
    if (at_ == end_)
        fail("truncated: the file ends before its last element");
    if (*at_ == '+')
        ++at_;
    double result = 0;
    const auto [stop, error] = std::from_chars(at_, end_, result);
    if (error == std::errc::invalid_argument)
        fail(quoted_excerpt({at_, end_}) + " is not a number");
    at_ = stop;
    return result;
}

std::uint64_t PlyReader::list_length(const Property &property) {
    const double length = value(*property.count_type);
    if (!(length >= 0) || length != std::floor(length) || length > 4294967295.0)
        fail("a list of length " + std::to_string(length));
    const std::uint64_t least = ascii_ ? 1 : size_of(property.type);
    if (std::uint64_t(length) > std::uint64_t(end_ - at_) / least)
        fail("truncated: a list is longer than the rest of the file");
    return std::uint64_t(length);
}

void PlyReader::skip(const Property &property) {
    if (!property.count_type)
        value(property.type);
    else if (const std::uint64_t length = list_length(property); ascii_)
        for (std::uint64_t i = 0; i < length; ++i)
            value(property.type);
    else
        at_ += length * size_of(property.type);
}

/// Those that are wanted, of which the mesh has got room for what they are.
std::vector<PlyAttribute> PlyReader::attributes_of(const ElementDeclaration &element, const char *prefix) {
    std::vector<PlyPropertyName> names;
    for (const Property &property : element.properties) {
        const float largest = property.type == Scalar::uint8 ? 255 : property.type == Scalar::uint16 ? 65535 : 0;
        names.push_back({property.name, property.count_type.has_value(), largest});
    }
    std::optional<std::string> error;
    const std::vector<PlyAttribute> found = find_ply_attributes(prefix, names, wanted_, error);
    if (error)
        fail(*error);
    for (const PlyAttribute &attribute : found)
        mesh_.attributes.push_back({attribute.name, std::uint32_t(attribute.properties.size()), {}});
    return found;
}

void PlyReader::read_vertices(const ElementDeclaration &element) {
    if (element.count > std::numeric_limits<std::int32_t>::max())
        fail("more vertices than 32-bit indices hold");
    // Where each property goes: 0 to 2 position, 3 to 5 normal, 6 and 7 texture coordinates, 8 nowhere, then
    // attributes.
    constexpr std::size_t nowhere = 8;
    std::vector<std::size_t> targets;
    bool present[nowhere + 1] = {};
    for (const Property &property : element.properties) {
        constexpr const char *names[nowhere] = {"x", "y", "z", "nx", "ny", "nz", "u", "v"};
        std::string name = property.name;
        if (name == "s" || name == "texture_u")
            name = "u";
        if (name == "t" || name == "texture_v")
            name = "v";
        const auto found = property.count_type ? std::end(names) : std::find(std::begin(names), std::end(names), name);
        targets.push_back(std::size_t(found - std::begin(names)));
        present[targets.back()] = true;
    }
    if (!present[0] || !present[1] || !present[2])
        fail("the vertices have no x, y and z");
    const bool has_normals = present[3] && present[4] && present[5], has_texcoords = present[6] && present[7];
    const std::size_t first_attribute = mesh_.attributes.size();
    std::size_t targets_used = nowhere + 1;
    const std::vector<PlyAttribute> attributes = attributes_of(element, "vertex_");
    for (const PlyAttribute &attribute : attributes)
        for (const std::size_t property : attribute.properties)
            targets[property] = targets_used++;
    // What vertex i has of them.
    const auto keep_attributes = [&](const std::vector<float> &values, std::size_t i) {
        std::size_t from = nowhere + 1;
        for (std::size_t a = 0; a < attributes.size(); ++a) {
            const std::size_t channels = attributes[a].properties.size();
            for (std::size_t c = 0; c < channels; ++c)
                mesh_.attributes[first_attribute + a].values[i * channels + c] = values[from++] / attributes[a].unit;
        }
    };
    const auto make_room = [&](std::size_t count) {
        for (std::size_t a = 0; a < attributes.size(); ++a)
            mesh_.attributes[first_attribute + a].values.resize(count * attributes[a].properties.size());
    };
    const bool is_fixed = !ascii_ && std::ranges::none_of(element.properties, [](const Property &property) {
        return property.count_type.has_value();
    });
    if (is_fixed) {
        std::size_t stride = 0;
        for (const Property &property : element.properties)
            stride += size_of(property.type);
        if (element.count > std::uint64_t(end_ - at_) / stride)
            fail("truncated: the file ends before its last element");
        mesh_.positions.resize(element.count);
        mesh_.normals.resize(has_normals ? element.count : 0);
        mesh_.texcoords.resize(has_texcoords ? element.count : 0);
        make_room(element.count);
        tbb::parallel_for(Tasks(0, element.count, vertices_a_task), [&](const Tasks &range) {
            const char *from = at_ + range.begin() * stride;
            std::vector<float> values(targets_used);
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                for (std::size_t p = 0; p < targets.size(); ++p) {
                    const Scalar type = element.properties[p].type;
                    values[targets[p]] = float(load_scalar(from, type, swap_));
                    from += size_of(type);
                }
                mesh_.positions[i] = {values[0], values[1], values[2]};
                if (has_normals)
                    mesh_.normals[i] = {values[3], values[4], values[5]};
                if (has_texcoords)
                    mesh_.texcoords[i] = {values[6], values[7]};
                keep_attributes(values, i);
            }
        });
        at_ += element.count * stride;
        return;
    }
    mesh_.positions.reserve(element.count);
    std::vector<float> values(targets_used);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < targets.size(); ++p) {
            const Property &property = element.properties[p];
            if (property.count_type)
                skip(property);
            else
                values[targets[p]] = float(value(property.type));
        }
        mesh_.positions.push_back({values[0], values[1], values[2]});
        if (has_normals)
            mesh_.normals.push_back({values[3], values[4], values[5]});
        if (has_texcoords)
            mesh_.texcoords.push_back({values[6], values[7]});
        make_room(i + 1);
        keep_attributes(values, i);
    }
}

/// Faces as nearly all files have them: binary, nothing but indices of 32 bits, all of them triangles. False, with
/// nothing read, for others, and for those with an index that is out of range.
bool PlyReader::read_triangles(const ElementDeclaration &element) {
    const Property &property = element.properties.front();
    const bool is_plain = !ascii_ && !swap_ && element.properties.size() == 1 && property.count_type &&
                          size_of(*property.count_type) == 1 && is_index(property.name) &&
                          (property.type == Scalar::int32 || property.type == Scalar::uint32);
    constexpr std::size_t stride = 1 + 3 * sizeof(std::uint32_t);
    if (!is_plain || element.count > std::uint64_t(end_ - at_) / stride)
        return false;
    mesh_.triangles.resize(element.count);
    std::atomic<bool> are_plain = true;
    tbb::parallel_for(Tasks(0, element.count, vertices_a_task), [&](const Tasks &range) {
        bool plain = true;
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const char *from = at_ + i * stride;
            auto &triangle = mesh_.triangles[i];
            std::memcpy(triangle.data(), from + 1, sizeof triangle);
            plain = plain && *from == 3 && ((triangle[0] | triangle[1] | triangle[2]) >> 31) == 0;
        }
        if (!plain)
            are_plain = false;
    });
    if (are_plain)
        at_ += element.count * stride;
    else
        mesh_.triangles.clear();
    return are_plain;
}

/// A fan of triangles. Fewer than three corners are a triangle without area, which is left out and counted like others.
/// texcoords: u and v of each corner, where faces have them; of a face without any they are 0.
void PlyReader::add_polygon(std::vector<std::uint32_t> &polygon, std::vector<float> *texcoords) {
    if (texcoords && !texcoords->empty() && texcoords->size() != 2 * polygon.size())
        fail(fmt::format("a face of {} corners has {} texture coordinates, not two each", polygon.size(),
                         texcoords->size()));
    if (polygon.empty() && has_vertices_)
        polygon.push_back(0);
    if (!polygon.empty())
        polygon.resize(std::max<std::size_t>(polygon.size(), 3), polygon.back());
    if (texcoords)
        texcoords->resize(2 * polygon.size());
    for (std::size_t corner = 2; corner < polygon.size(); ++corner) {
        mesh_.triangles.push_back({polygon[0], polygon[corner - 1], polygon[corner]});
        if (texcoords)
            for (const std::size_t i : {std::size_t(0), corner - 1, corner})
                corner_texcoords_.push_back({(*texcoords)[2 * i], (*texcoords)[2 * i + 1]});
    }
}

void PlyReader::read_faces(const ElementDeclaration &element) {
    if (!element.properties.empty() && read_triangles(element))
        return;
    const std::size_t first_attribute = mesh_.attributes.size();
    const std::vector<PlyAttribute> attributes = attributes_of(element, "face_");
    std::vector<char> is_kept(element.properties.size(), 0);
    for (const PlyAttribute &attribute : attributes)
        for (const std::size_t property : attribute.properties)
            is_kept[property] = 1;
    std::vector<float> values(element.properties.size());
    std::vector<std::uint32_t> polygon;
    std::vector<float> texcoords;
    const bool has_texcoords = std::ranges::any_of(element.properties, is_corner_texcoords);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        polygon.clear();
        texcoords.clear();
        const std::size_t first_triangle = mesh_.triangles.size();
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const Property &property = element.properties[p];
            const bool is_indices = property.count_type && is_index(property.name);
            if (is_kept[p]) {
                values[p] = float(value(property.type));
                continue;
            }
            if (is_corner_texcoords(property)) {
                for (std::uint64_t left = list_length(property); left > 0; --left)
                    texcoords.push_back(float(value(property.type)));
                continue;
            }
            if (!is_indices) {
                skip(property);
                continue;
            }
            const std::uint64_t length = list_length(property);
            for (std::uint64_t corner = 0; corner < length; ++corner) {
                const double index = value(property.type);
                if (!(index >= 0) || index > 4294967295.0 || index != std::floor(index))
                    fail("face index " + std::to_string(index) + " is out of range");
                polygon.push_back(std::uint32_t(index));
            }
        }
        add_polygon(polygon, has_texcoords ? &texcoords : nullptr);
        for (std::size_t triangle = first_triangle; triangle < mesh_.triangles.size(); ++triangle)
            for (std::size_t a = 0; a < attributes.size(); ++a)
                for (const std::size_t property : attributes[a].properties)
                    mesh_.attributes[first_attribute + a].values.push_back(values[property] / attributes[a].unit);
    }
}

} // namespace

Mesh parse_ply(const std::string &data, const std::string &file_name, const std::vector<std::string> &attributes) {
    return PlyReader(data, file_name, attributes).read();
}

} // namespace gradus
