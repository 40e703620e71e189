// Wavefront OBJ. A reader of our own: exact line numbers in errors, no crash on broken files, and from_chars speed.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "runtime/io/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <compare>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>

namespace gradus {

/// A corner of a face: indices from 0, `none` where the file gives none.
struct ObjCorner {
    std::uint32_t position, texcoord, normal;
    auto operator<=>(const ObjCorner &) const = default;
};

/// Positions, texcoords and normals of a file, which faces share.
struct ObjLists {
    std::vector<Vector3> positions, normals;
    std::vector<std::array<float, 2>> texcoords;
};

namespace {

constexpr std::uint32_t none = 0xffffffffu;

constexpr int longest_list = 16; // of vertices that share a position

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

void skip_blanks(const char *&at, const char *end) {
    while (at < end && is_blank(*at))
        ++at;
}

/// The lines of a file one after the other, without blanks before them.
class ObjLines {
  public:
    explicit ObjLines(const std::string &text)
        : next_(text.data() + byte_order_mark(text).size()), end_of_text_(text.data() + text.size()) {}

    /// False after the last.
    bool next() {
        if (next_ >= end_of_text_)
            return false;
        number_ += 1 + more_;
        more_ = 0;
        begin_ = next_;
        end_ = end_of_line(begin_);
        next_ = after_line(end_);
        if (goes_on())
            join();
        skip_blanks(begin_, end_);
        return true;
    }
    const char *begin() const { return begin_; }
    const char *end() const { return end_; }
    std::string_view text() const { return {begin_, std::size_t(end_ - begin_)}; }
    std::size_t number() const { return number_; } ///< from 1; of several that are joined the first

  private:
    const char *end_of_line(const char *at) const {
        while (at < end_of_text_ && *at != '\n' && *at != '\r')
            ++at;
        return at;
    }
    const char *after_line(const char *line_end) const {
        const bool ends_twice = line_end + 1 < end_of_text_ && line_end[0] == '\r' && line_end[1] == '\n';
        return std::min(line_end + (ends_twice ? 2 : 1), end_of_text_);
    }
    /// Whether a backslash ends a line of numbers, which has more on the next. Elsewhere it ends a path.
    bool goes_on() const {
        const char *at = begin_;
        skip_blanks(at, end_);
        return end_ - at >= 2 && (*at == 'v' || *at == 'f') && end_[-1] == '\\';
    }
    void join() {
        joined_.clear();
        for (; end_ > begin_ && end_[-1] == '\\'; ++more_) {
            joined_.append(begin_, end_ - 1) += ' ';
            begin_ = next_;
            end_ = end_of_line(begin_);
            next_ = after_line(end_);
        }
        joined_.append(begin_, end_);
        begin_ = joined_.data();
        end_ = joined_.data() + joined_.size();
    }

    const char *next_, *const end_of_text_;
    const char *begin_ = nullptr, *end_ = nullptr;
    std::size_t number_ = 0, more_ = 0; ///< lines that were joined to this one
    std::string joined_;
};

/// What a line that begins with the word names; it has no blanks before it.
std::optional<std::string> named_after(std::string_view word, std::string_view line) {
    if (!line.starts_with(word) || line.size() == word.size() || !is_blank(line[word.size()]))
        return std::nullopt;
    return std::string(trimmed(line.substr(word.size())));
}
std::optional<std::string> material_named(std::string_view line) { return named_after("usemtl", line); }

/// A mesh of some of the faces: corners that are alike become one vertex, and polygons fans.
class MeshOfFaces {
  public:
    /// most_corners: of its faces, if that is known.
    MeshOfFaces(const ObjLists &lists, const std::string &file_name,
                std::size_t most_corners = std::numeric_limits<std::size_t>::max())
        : lists_(lists), file_name_(file_name), is_small_(most_corners < lists.positions.size() / 8) {}

    void begin_material(const std::string &) {}
    /// One or two corners are a triangle without area, which is left out and counted like any other.
    void add_face(std::span<const ObjCorner> face) {
        polygon_.clear();
        for (const ObjCorner &corner : face)
            polygon_.push_back(vertex_of(corner));
        if (!polygon_.empty())
            polygon_.resize(std::max<std::size_t>(polygon_.size(), 3), polygon_.back());
        for (std::size_t i = 2; i < polygon_.size(); ++i)
            triangles_.push_back({polygon_[0], polygon_[i - 1], polygon_[i]});
    }
    Mesh assemble();

  private:
    std::uint32_t vertex_of(const ObjCorner &corner);
    std::uint32_t &first_at(std::uint32_t position);

    const ObjLists &lists_;
    const std::string &file_name_;
    std::vector<ObjCorner> corners_;          // by vertex of the mesh
    std::vector<std::uint32_t> first_, next_; // the first few vertices that share a position, as lists
    const bool is_small_;                     // beside the file, of which it may be one of thousands of parts
    std::unordered_map<std::uint32_t, std::uint32_t> first_of_small_; // in place of first_
    std::map<ObjCorner, std::uint32_t> crowded_; // the others: a list of all would be searched for each corner
    std::vector<std::uint32_t> polygon_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
};

/// `Faces`: takes the faces one after the other, and the name of their material before each that has another.
template <class Faces>
class ObjReader {
  public:
    /// The lists are filled while the file is read.
    ObjReader(const std::string &text, const std::string &file_name, const std::filesystem::path &place,
              ObjLists &lists, Faces &faces)
        : lines_(text), file_name_(file_name), lists_(lists), faces_(faces),
          quotes_(lower_case((place.empty() ? std::filesystem::path(file_name) : place).extension().string()) ==
                  ".obj") {}

    void read() {
        while (lines_.next())
            read_line(lines_.begin(), lines_.end());
    }

  private:
    [[noreturn]] void fail(const std::string &message) const {
        throw SceneError({std::make_shared<const std::string>(file_name_), lines_.number()}, message);
    }

    /// What stands there, for messages; or nothing of it where the file may be anybody's.
    std::string quoted(const char *at, const char *end) const {
        return quotes_ ? quoted_excerpt({at, std::size_t(end - at)}) : "what stands there";
    }

    void read_line(const char *at, const char *end);
    int read_floats(const char *&at, const char *end, float *values, int count) const;
    void read_face(const char *at, const char *end);
    std::uint32_t read_index(const char *&at, const char *end, std::size_t count, const char *kind) const;

    ObjLines lines_;
    const std::string &file_name_;
    ObjLists &lists_;
    Faces &faces_;
    bool quotes_;
    std::vector<ObjCorner> face_;
};

/// How long what follows "1." is, where that is no number as Microsoft's library writes it; else 0.
std::size_t written_as_none(std::string_view rest) {
    for (const std::string_view name : {"#IND", "#INF", "#QNAN", "#SNAN"})
        if (rest.starts_with(name))
            return name.size();
    return 0;
}

template <class Faces>
int ObjReader<Faces>::read_floats(const char *&at, const char *end, float *values, int count) const {
    for (int i = 0; i < count; ++i) {
        skip_blanks(at, end);
        if (at == end || *at == '#')
            return i;
        if (*at == '+')
            ++at;
        double value = 0;
        auto [stop, error] = std::from_chars(at, end, value);
        if (stop < end && *stop == '#')
            if (const std::size_t length = written_as_none({stop, std::size_t(end - stop)})) {
                value = NAN;
                stop += length;
            }
        if (error == std::errc::invalid_argument || (stop < end && !is_blank(*stop) && *stop != '#'))
            fail(quoted(at, end) + " is not a number");
        values[i] = error == std::errc() ? float(value) : 0.0f; // out of a double's range: nothing to keep
        at = stop;
    }
    return count;
}

template <class Faces>
void ObjReader<Faces>::read_line(const char *at, const char *end) {
    if (end - at < 2)
        return;
    if (at[0] == 'v') {
        float values[3] = {0, 0, 0};
        if (is_blank(at[1])) {
            at += 1;
            if (read_floats(at, end, values, 3) != 3)
                fail("v needs three numbers");
            lists_.positions.push_back({values[0], values[1], values[2]});
        } else if (at[1] == 't') {
            at += 2;
            if (read_floats(at, end, values, 2) < 1)
                fail("vt needs two numbers");
            lists_.texcoords.push_back({values[0], values[1]});
        } else if (at[1] == 'n') {
            at += 2;
            if (read_floats(at, end, values, 3) != 3)
                fail("vn needs three numbers");
            lists_.normals.push_back({values[0], values[1], values[2]});
        }
    } else if (at[0] == 'f' && is_blank(at[1])) {
        read_face(at + 1, end);
    } else if (const auto material = material_named({at, std::size_t(end - at)})) {
        faces_.begin_material(*material);
    }
}

/// An index from 1, or from the end where negative, as one from 0.
template <class Faces>
std::uint32_t ObjReader<Faces>::read_index(const char *&at, const char *end, std::size_t count,
                                           const char *kind) const {
    long long index = 0;
    const auto [stop, error] = std::from_chars(at, end, index);
    if (error == std::errc::invalid_argument)
        fail(std::string("a face needs indices, not ").append(quoted(at, end)));
    at = stop;
    const long long from_zero = index > 0 ? index - 1 : index + (long long)count;
    if (error != std::errc() || index == 0 || from_zero < 0 || from_zero >= (long long)count)
        fail(fmt::format("face index out of range: {}{} of {}", kind, quotes_ ? fmt::format(" {}", index) : "", count));
    return std::uint32_t(from_zero);
}

template <class Faces>
void ObjReader<Faces>::read_face(const char *at, const char *end) {
    face_.clear();
    for (;;) {
        skip_blanks(at, end);
        if (at == end || *at == '#')
            break;
        ObjCorner corner{none, none, none};
        corner.position = read_index(at, end, lists_.positions.size(), "v");
        if (at < end && *at == '/') {
            ++at;
            if (at < end && *at != '/' && !is_blank(*at))
                corner.texcoord = read_index(at, end, lists_.texcoords.size(), "vt");
            if (at < end && *at == '/') {
                ++at;
                if (at < end && !is_blank(*at))
                    corner.normal = read_index(at, end, lists_.normals.size(), "vn");
            }
        }
        if (at < end && !is_blank(*at))
            fail("a face corner is v, v/vt, v//vn or v/vt/vn; cannot read " + quoted(at, end));
        face_.push_back(corner);
    }
    faces_.add_face(face_);
}

std::uint32_t &MeshOfFaces::first_at(std::uint32_t position) {
    if (is_small_)
        return first_of_small_.try_emplace(position, none).first->second;
    if (first_.size() < lists_.positions.size())
        first_.resize(lists_.positions.size(), none);
    return first_[position];
}

std::uint32_t MeshOfFaces::vertex_of(const ObjCorner &corner) {
    std::uint32_t &first = first_at(corner.position);
    int length = 0;
    for (std::uint32_t vertex = first; vertex != none; vertex = next_[vertex], ++length)
        if (corners_[vertex] == corner)
            return vertex;
    if (length >= longest_list)
        if (const auto known = crowded_.find(corner); known != crowded_.end())
            return known->second;
    if (corners_.size() >= std::numeric_limits<std::int32_t>::max())
        throw SceneError({std::make_shared<const std::string>(file_name_)}, "more vertices than 32-bit indices hold");
    const auto vertex = std::uint32_t(corners_.size());
    corners_.push_back(corner);
    next_.push_back(none);
    if (length >= longest_list) {
        crowded_.emplace(corner, vertex);
    } else {
        next_.back() = first;
        first = vertex;
    }
    return vertex;
}

Mesh MeshOfFaces::assemble() {
    Mesh mesh;
    mesh.triangles = std::move(triangles_);
    mesh.positions.reserve(corners_.size());
    bool any_normal = false, any_texcoord = false;
    for (const ObjCorner &corner : corners_) {
        mesh.positions.push_back(lists_.positions[corner.position]);
        any_normal |= corner.normal != none;
        any_texcoord |= corner.texcoord != none;
    }
    // A zero normal marks a vertex without one; build_mesh() computes it.
    if (any_normal)
        for (const ObjCorner &corner : corners_)
            mesh.normals.push_back(corner.normal == none ? Vector3{} : lists_.normals[corner.normal]);
    if (any_texcoord)
        for (const ObjCorner &corner : corners_)
            mesh.texcoords.push_back(corner.texcoord == none ? std::array<float, 2>{0, 0}
                                                             : lists_.texcoords[corner.texcoord]);
    return mesh;
}

} // namespace

/// The faces of a file as they stand in it.
struct ObjFile::Content {
    std::string file_name;
    ObjLists lists;
    std::vector<ObjCorner> corners;
    std::vector<std::uint32_t> corners_of_face;
    /// Of faces one after the other that have the same material.
    struct Run {
        std::size_t first_face, first_corner, faces = 0, corners = 0;
    };
    std::map<std::string, std::vector<Run>> runs; ///< by material
    std::string material;
    Run *run = nullptr; ///< the last; nullptr: its first face is still to come

    void begin_material(const std::string &its_name) {
        material = its_name;
        run = nullptr;
    }
    void add_face(std::span<const ObjCorner> face) {
        if (!run)
            run = &runs[material].emplace_back(Run{corners_of_face.size(), corners.size()});
        ++run->faces;
        run->corners += face.size();
        corners.insert(corners.end(), face.begin(), face.end());
        corners_of_face.push_back(std::uint32_t(face.size()));
    }
};

ObjFile::ObjFile(const std::string &text, const std::string &file_name, const std::filesystem::path &place)
    : content_(std::make_unique<Content>()) {
    content_->file_name = file_name;
    ObjReader(text, file_name, place, content_->lists, *content_).read();
}

ObjFile::ObjFile(ObjFile &&) noexcept = default;
ObjFile &ObjFile::operator=(ObjFile &&) noexcept = default;
ObjFile::~ObjFile() = default;

Mesh ObjFile::mesh(const FacesOf &faces) const {
    std::vector<Content::Run> runs;
    const auto take = [&](const std::vector<Content::Run> &more) { runs.insert(runs.end(), more.begin(), more.end()); };
    if (faces.others) {
        for (const auto &[material, its_runs] : content_->runs)
            if (faces.has(material))
                take(its_runs);
    } else {
        for (const std::string &material : faces.materials)
            if (const auto found = content_->runs.find(material); found != content_->runs.end())
                take(found->second);
    }
    std::ranges::sort(runs, {}, &Content::Run::first_face); // as the file has them
    std::size_t corners = 0;
    for (const Content::Run &run : runs)
        corners += run.corners;
    MeshOfFaces mesh(content_->lists, content_->file_name, corners);
    for (const Content::Run &run : runs) {
        const ObjCorner *corner = content_->corners.data() + run.first_corner;
        for (std::size_t face = run.first_face; face < run.first_face + run.faces; ++face) {
            mesh.add_face({corner, content_->corners_of_face[face]});
            corner += content_->corners_of_face[face];
        }
    }
    return mesh.assemble();
}

bool ObjFile::has_material(const std::string &material) const { return content_->runs.contains(material); }

Mesh parse_obj(const std::string &text, const std::string &file_name, const std::filesystem::path &place) {
    ObjLists lists;
    MeshOfFaces mesh(lists, file_name);
    ObjReader(text, file_name, place, lists, mesh).read();
    return mesh.assemble();
}

ObjNames names_in_obj(const std::string &text) {
    ObjNames found;
    std::string material;
    for (ObjLines lines(text); lines.next();) {
        const std::string_view line = lines.text();
        if (line.size() > 1 && line[0] == 'f' && is_blank(line[1]))
            found.materials.insert(material);
        else if (auto named = material_named(line))
            material = *std::move(named);
        else if (auto library = named_after("mtllib", line))
            found.libraries.push_back({*std::move(library), lines.number()});
    }
    return found;
}

} // namespace gradus
