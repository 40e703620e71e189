#include "runtime/io/document.h"

#include "runtime/error.h"
#include "runtime/io/entities.h"
#include "runtime/io/known_attributes.h"
#include "runtime/io/parameters.h"
#include "runtime/io/properties.h"
#include "runtime/io/spectrum_file.h"
#include "runtime/io/text.h"
#include "runtime/io/text_encoding.h"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <iterator>
#include <string_view>

namespace gradus {
namespace fs = std::filesystem;

namespace {

constexpr int deepest_nesting = 100;
constexpr int deepest_include = 16; // as Mitsuba has it: enough for people, an end for circles
constexpr std::size_t most_folders = 32;
constexpr std::uint64_t most_spectrum_bytes = 1u << 20; // of a file: thousands of wavelengths

[[noreturn]] void fail(const Location &location, const std::string &message) {
    throw Error(ExitCode::scene, located(location, message));
}

/// One XML file, kept while its elements are turned into ours.
struct File {
    std::shared_ptr<const std::string> name;
    fs::path path;
    std::vector<std::size_t> line_starts;
    std::string text; ///< which `xml` is parsed in
    pugi::xml_document xml;
    int version = 3;

    Location locate(std::ptrdiff_t offset) const {
        if (offset < 0)
            return {name, 0};
        const auto after = std::upper_bound(line_starts.begin(), line_starts.end(), std::size_t(offset));
        return {name, std::size_t(after - line_starts.begin())};
    }
    Location locate(const pugi::xml_node &node) const { return locate(node.offset_debug()); }
};

class Reader {
  public:
    Reader(const LoadOptions &options, FileFinder &finder, Diagnostics &diagnostics)
        : limits_(options.limits), parameters_(options.parameters, options.limits), finder_(finder),
          diagnostics_(diagnostics) {}

    Document read(const std::string &path) {
        const auto main = open(OpenFile::open(path), path, std::nullopt);
        folders_.push_back(main->path.parent_path());
        collect_parameters(*main, main->xml.document_element(), 0);
        read_deferred_includes();
        diagnostics_.throw_if_errors();
        Document document;
        document.root = convert(*main, main->xml.document_element(), 0);
        diagnostics_.throw_if_errors();
        parameters_.check_given();
        document.search_folders = folders_;
        return document;
    }

  private:
    /// `including`: the version of the file that includes it; none of the scene's own file.
    /// `is_entity`: named by an entity.
    std::unique_ptr<File> open(const std::shared_ptr<const OpenFile> &opened, const fs::path &path,
                               std::optional<int> including, bool is_entity = false);
    /// Puts what the file says in the place of its name.
    void read_spectrum(const File &file, Element &spectrum);
    /// Tells of those that nobody reads.
    void check_attributes(const File &file, const pugi::xml_node &node);
    void check_root(const File &file, const pugi::xml_node &root, bool is_main) const;
    void check_entity(const File &file, const pugi::xml_node &root) const;
    void collect_parameters(const File &file, const pugi::xml_node &node, int depth);
    void add_default(const File &file, const pugi::xml_node &node);
    void add_include(const File &file, const pugi::xml_node &node, int depth);
    bool open_include(const File &file, const pugi::xml_node &node, int depth, bool last_chance);
    /// Beside `file`, or in the folders to search; an error where it is in none of them.
    std::optional<fs::path> find(const File &file, const Location &location, const char *what, const std::string &name,
                                 bool is_include_of_include = false);
    void read_deferred_includes();
    Element convert(const File &file, const pugi::xml_node &node, int depth);
    void convert_children(const File &file, pugi::xml_node parent, Element &element, int depth);
    void add_folder(const File &file, const pugi::xml_node &node, const std::string &value);

    struct Deferred {
        const File *file;
        pugi::xml_node node;
        int depth;
    };

    const LoadLimits limits_;
    Parameters parameters_;
    FileFinder &finder_;
    Diagnostics &diagnostics_;
    std::vector<fs::path> folders_;
    std::vector<Deferred> deferred_;
    /// By the <include> that asked for it: the file and the node's own address in its document.
    std::map<const void *, std::unique_ptr<File>> included_;
    std::uint64_t xml_bytes_ = 0, includes_ = 0, elements_ = 0;
};

/// opened: nullptr where it cannot be read.
std::unique_ptr<File> Reader::open(const std::shared_ptr<const OpenFile> &opened, const fs::path &path,
                                   std::optional<int> including, bool is_entity) {
    auto file = std::make_unique<File>();
    file->name = std::make_shared<const std::string>(path.string());
    file->path = path;
    const Location whole{file->name, 0};
    const std::uint64_t size = opened ? opened->bytes() : 0;
    if (size <= limits_.xml_bytes)
        xml_bytes_ += size;
    if (size > limits_.xml_bytes || xml_bytes_ > limits_.xml_bytes)
        fail(whole, "the scene's files have more than " + std::to_string(limits_.xml_bytes >> 20) + " MiB of XML" +
                        limits_hint);
    std::optional<std::string> text = opened ? opened->read() : std::nullopt;
    const bool is_utf8 = text && convert_to_utf8(*text);
    if (text)
        text = with_entities(*std::move(text), limits_.xml_bytes);
    if (text && is_entity) // it may have any number of roots
        text = "<scene>" + *text + "</scene>";
    if (!text) // of files that a stranger's scene names it stays untold whether they are there
        fail(whole, "cannot read this scene file" + (including ? "" : why_not(path)));
    file->line_starts.push_back(0);
    for (std::size_t i = 0; i < text->size(); ++i)
        if ((*text)[i] == '\n')
            file->line_starts.push_back(i + 1);
    file->text = std::move(*text);
    const pugi::xml_parse_result result = file->xml.load_buffer_inplace(
        file->text.data(), file->text.size(), pugi::parse_default, is_utf8 ? pugi::encoding_utf8 : pugi::encoding_auto);
    if (result.status == pugi::status_no_document_element)
        fail(whole, "not well-formed XML: there is no element in it; a scene is an XML file");
    if (!result)
        fail(file->locate(result.offset), std::string("not well-formed XML: ") + result.description());
    const pugi::xml_node root = file->xml.document_element();
    if (is_entity)
        check_entity(*file, root);
    check_root(*file, root, !including);
    check_attributes(*file, root);
    file->version = including.value_or(3);
    const Location location = file->locate(root);
    if (const pugi::xml_attribute attribute = root.attribute("version")) {
        const std::string value = attribute.value();
        const std::optional<double> number = parse_number(value.substr(0, value.find('.')));
        if (!number || *number < 0 || *number > 1000)
            fail(location, "version=\"" + shortened(value, 40) + "\" is no version number");
        file->version = int(*number);
        if (file->version == 1 || file->version > 3) {
            diagnostics_.warn(location, "version=\"" + shortened(value, 40) + "\" is of no Mitsuba that is known here" +
                                            "; read as version 3 (of 0.6 and before it is 0.6.0)");
            file->version = 3;
        }
    } else if (!including)
        diagnostics_.warn(location, "<scene> has no version; read as version 3");
    return file;
}

/// What a file says is only told to the user once it is known to be a scene's: an <include> can name any file.
void Reader::check_root(const File &file, const pugi::xml_node &root, bool is_main) const {
    const std::string tag = root.name();
    if (tag != "scene" && !is_object_tag(tag))
        fail(file.locate(root), is_main ? "the root element is no <scene>"
                                        : "not a part of a scene: the root element is no <scene> and no object");
    if (is_main && tag != "scene")
        fail(file.locate(root), "the root element is <" + tag + ">; a scene file begins with <scene>");
    if (const pugi::xml_node second = root.next_sibling(); second && second.type() == pugi::node_element)
        fail(file.locate(second), "a second root element" +
                                      (is_object_tag(second.name()) || second.name() == std::string("scene")
                                           ? std::string(" <") + second.name() + ">"
                                           : std::string()) +
                                      "; a scene file has one");
}

/// The same of a file without a root of its own: it holds nothing but what may stand in a <scene>.
void Reader::check_entity(const File &file, const pugi::xml_node &root) const {
    for (const pugi::xml_node &child : root.children()) {
        const std::string tag = child.name();
        if (!is_object_tag(tag) && tag != "scene" && tag != "default" && tag != "include" && tag != "path" &&
            tag != "alias" && tag != "ref")
            fail(file.locate(root), "not a part of a scene: something in it is no object");
    }
}

void Reader::add_folder(const File &file, const pugi::xml_node &node, const std::string &value) {
    if (folders_.size() > most_folders)
        fail(file.locate(node), "more than " + std::to_string(most_folders) + " folders to search");
    std::string folder(trimmed(value));
    std::ranges::replace(folder, '\\', '/');
    const fs::path path = file.path.parent_path() / folder;
    std::error_code error;
    if (!finder_.is_confined() && !fs::is_directory(path, error)) // of what is outside nothing is told
        diagnostics_.unknown(file.locate(node), "<path>: there is no folder \"" + path.string() + "\"");
    folders_.insert(folders_.begin(), path); // the last that is named goes first
}

void Reader::check_attributes(const File &file, const pugi::xml_node &node) {
    const auto *known = known_attributes(node.name());
    if (!known)
        return;
    const auto described = [&] {
        std::string text = fmt::format("<{}", node.name());
        for (const char *attribute : {"type", "name"})
            if (const pugi::xml_attribute found = node.attribute(attribute))
                text += fmt::format(" {}=\"{}\"", attribute, found.value());
        return text + ">";
    };
    const bool has_value = bool(node.attribute("value"));
    for (const pugi::xml_attribute &attribute : node.attributes()) {
        const std::string_view name = attribute.name();
        if (name == "id" || name == "name" || name == entity_attribute || name.starts_with("xml") /* namespaces */)
            continue;
        if (std::ranges::find(*known, name) == known->end())
            diagnostics_.unknown(file.locate(node), fmt::format("unknown attribute \"{}\" of {}", name, described()));
        else if (has_value && (name == "x" || name == "y" || name == "z"))
            diagnostics_.unknown(file.locate(node), fmt::format("{}: value stands for {}, too", described(), name));
    }
}

/// Of what stands in `parent`, however deep, and in the files that it includes; `depth`: of these.
void Reader::collect_parameters(const File &file, const pugi::xml_node &parent, int depth) {
    struct Walker final : pugi::xml_tree_walker {
        Reader &reader;
        const File &file;
        const int includes;
        Walker(Reader &r, const File &f, int i) : reader(r), file(f), includes(i) {}
        bool for_each(pugi::xml_node &node) override {
            const std::string_view tag = node.name();
            if (tag == "default") {
                reader.add_default(file, node);
            } else if (tag == "include") {
                reader.add_include(file, node, includes);
            } else if (tag == "path" && depth() == 0) {
                if (const std::string value = node.attribute("value").value(); value.find('$') == std::string::npos)
                    reader.add_folder(file, node, value);
            }
            return true;
        }
    };
    Walker walker(*this, file, depth);
    pugi::xml_node from = parent;
    from.traverse(walker);
}

void Reader::add_default(const File &file, const pugi::xml_node &node) {
    const std::string name(trimmed(node.attribute("name").value()));
    if (name.empty() || !node.attribute("value"))
        fail(file.locate(node), "<default> needs name and value");
    parameters_.add_default(name, node.attribute("value").value(), file.locate(node));
}

void Reader::add_include(const File &file, const pugi::xml_node &node, int depth) {
    if (++includes_ > limits_.includes)
        fail(file.locate(node), "more than " + std::to_string(limits_.includes) + " files are included" + limits_hint);
    if (!open_include(file, node, depth, false))
        deferred_.push_back({&file, node, depth});
}

/// False where the file name holds a parameter that is not known yet.
bool Reader::open_include(const File &file, const pugi::xml_node &node, int depth, bool last_chance) {
    const Location location = file.locate(node);
    if (!node.attribute("filename"))
        fail(location, "<include> needs filename");
    if (depth >= deepest_include)
        fail(location, "more than " + std::to_string(deepest_include) + " includes deep; a circle?");
    const std::string written = node.attribute("filename").value();
    std::string name;
    if (last_chance)
        name = parameters_.expand(written, location);
    else if (!parameters_.try_expand(written, location, name))
        return false;
    const std::optional<fs::path> found = find(file, location, "included file", name, depth > 0);
    if (!found) // reported with all the others before anything else is read
        return true;
    auto included = open(finder_.open(*found), *found, file.version, bool(node.attribute(entity_attribute)));
    const File &opened = *included;
    included_[node.internal_object()] = std::move(included);
    collect_parameters(opened, opened.xml.document_element(), depth + 1);
    return true;
}

std::optional<fs::path> Reader::find(const File &file, const Location &location, const char *what,
                                     const std::string &name, bool is_include_of_include) {
    std::vector<fs::path> folders = folders_;
    // Before that of the scene; of a file that is included before all others, as others' programs have it.
    folders.insert(is_include_of_include ? folders.begin() : folders.end() - 1, file.path.parent_path());
    const std::optional<FoundFile> found = finder_.find(name, folders);
    if (!found) {
        diagnostics_.error(location,
                           fmt::format("cannot find the {} \"{}\"{}", what, name, finder_.why_not(name, folders)));
        return std::nullopt;
    }
    if (!found->exact)
        diagnostics_.warn(location, "\"" + name + "\" differs in case from the file " + found->path.string());
    return found->path;
}

void Reader::read_spectrum(const File &file, Element &spectrum) {
    const std::string name = *spectrum.attribute("filename");
    const std::optional<fs::path> found = find(file, spectrum.location, "file of a spectrum", name);
    const auto opened = found ? finder_.open(*found) : nullptr;
    const std::optional<std::string> text =
        opened && opened->bytes() <= most_spectrum_bytes ? opened->read() : std::nullopt;
    const std::optional<std::string> value = text ? spectrum_of_file(*text) : std::nullopt;
    if (found && !value) // of files that a stranger's scene names no more is told
        diagnostics_.error(spectrum.location, "\"" + name +
                                                  "\" is no file of a spectrum: it needs a wavelength in nm " +
                                                  "and a value on each line");
    std::erase_if(spectrum.attributes, [](const auto &attribute) { return attribute.first == "filename"; });
    spectrum.attributes.emplace_back("value", value.value_or("0"));
}

void Reader::read_deferred_includes() {
    for (bool progress = true; progress && !deferred_.empty();) {
        progress = false;
        std::vector<Deferred> waiting;
        waiting.swap(deferred_);
        for (const Deferred &include : waiting)
            if (open_include(*include.file, include.node, include.depth, false))
                progress = true;
            else
                deferred_.push_back(include);
    }
    for (const Deferred &include : deferred_)
        open_include(*include.file, include.node, include.depth, true); // throws with the name that is missing
}

Element Reader::convert(const File &file, const pugi::xml_node &node, int depth) {
    const Location location = file.locate(node);
    if (depth > deepest_nesting)
        fail(location, "elements are nested more than " + std::to_string(deepest_nesting) + " deep");
    if (++elements_ > limits_.elements)
        fail(location, "more than " + std::to_string(limits_.elements) + " elements" + limits_hint);
    Element element;
    element.tag = node.name();
    element.location = location;
    element.version = file.version;
    element.attributes.reserve(std::size_t(std::distance(node.attributes_begin(), node.attributes_end())));
    for (const pugi::xml_attribute &attribute : node.attributes())
        element.attributes.emplace_back(attribute.name(),
                                        parameters_.expand_or_tell(attribute.value(), location, diagnostics_));
    if (element.tag == "spectrum" && element.attribute("filename") && !element.attribute("value"))
        read_spectrum(file, element);
    if (element.is_legacy() && element.tag == "bsdf")
        for (auto &[name, value] : element.attributes)
            if (name == "type" && value == "bump")
                value = "bumpmap"; // as 0.4 has it
    convert_children(file, node, element, depth);
    return element;
}

/// What has been converted is taken out of the XML tree: of millions of elements both would be the most that a scene
/// ever takes.
void Reader::convert_children(const File &file, pugi::xml_node parent, Element &element, int depth) {
    element.children.reserve(element.children.size() +
                             std::size_t(std::distance(parent.children().begin(), parent.children().end())));
    pugi::xml_node done;
    for (pugi::xml_node child = parent.first_child(); child; child = child.next_sibling()) {
        if (done)
            parent.remove_child(done);
        done = child;
        if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
            diagnostics_.unknown(file.locate(child),
                                 "stray text \"" + std::string(trimmed(child.value())).substr(0, 40) + "\" is ignored");
            continue;
        }
        if (child.type() != pugi::node_element)
            continue;
        check_attributes(file, child);
        const std::string_view tag = child.name();
        if (tag == "default")
            continue;
        if (tag == "path") {
            const std::string value = child.attribute("value").value();
            if (value.find('$') != std::string::npos)
                add_folder(file, child, parameters_.expand(value, file.locate(child)));
            continue;
        }
        if (tag == "include") {
            const File &included = *included_.at(child.internal_object());
            const pugi::xml_node root = included.xml.document_element();
            if (std::string(root.name()) == "scene")
                convert_children(included, root, element, depth);
            else
                element.children.push_back(convert(included, root, depth + 1));
            continue;
        }
        element.children.push_back(convert(file, child, depth + 1));
    }
}

} // namespace

Document read_document(const std::string &path, const LoadOptions &options, FileFinder &finder,
                       Diagnostics &diagnostics) {
    return Reader(options, finder, diagnostics).read(path);
}

} // namespace gradus
