#include "runtime/io/document.h"

#include "runtime/error.h"
#include "runtime/io/file_search.h"
#include "runtime/io/text.h"

#include <pugixml.hpp>

#include <algorithm>
#include <set>

namespace gradus {
namespace fs = std::filesystem;

namespace {

constexpr int deepest_nesting = 100;
constexpr int deepest_include = 16; // as Mitsuba has it: enough for people, an end for circles

/// One XML file, kept while its elements are turned into ours.
struct File {
    std::shared_ptr<const std::string> name;
    fs::path path;
    std::vector<std::size_t> line_starts;
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
    Reader(const std::map<std::string, std::string> &given, Diagnostics &diagnostics)
        : given_(given), parameters_(given), diagnostics_(diagnostics) {}

    Document read(const std::string &path) {
        const auto main = open(path, fs::path(path), 0);
        folders_.insert(folders_.begin(), main->path.parent_path());
        collect_parameters(*main, main->xml.document_element(), 0);
        read_deferred_includes();
        diagnostics_.throw_if_errors();
        Document document;
        document.root = convert(*main, main->xml.document_element(), 0);
        check_given_parameters();
        document.search_folders = folders_;
        return document;
    }

  private:
    std::unique_ptr<File> open(const std::string &name, const fs::path &path, int version);
    void collect_parameters(const File &file, const pugi::xml_node &node, int depth);
    bool open_include(const File &file, const pugi::xml_node &node, int depth, bool last_chance);
    void read_deferred_includes();
    Element convert(const File &file, const pugi::xml_node &node, int depth);
    void convert_children(const File &file, const pugi::xml_node &parent, Element &element, int depth);
    std::string substitute(const std::string &text, const Location &location, int depth = 0);
    std::vector<std::string> parameter_names() const;
    void check_given_parameters() const;

    struct Deferred {
        const File *file;
        pugi::xml_node node;
        int depth;
    };

    const std::map<std::string, std::string> &given_;
    std::map<std::string, std::string> parameters_;
    std::set<std::string> used_;
    Diagnostics &diagnostics_;
    std::vector<fs::path> folders_;
    std::vector<Deferred> deferred_;
    /// By the <include> that asked for it: the file and the node's own address in its document.
    std::map<const void *, std::unique_ptr<File>> included_;
};

std::unique_ptr<File> Reader::open(const std::string &name, const fs::path &path, int version) {
    const std::optional<std::string> text = read_whole_file(path);
    if (!text)
        throw Error(ExitCode::scene, name + ": cannot read this scene file");
    auto file = std::make_unique<File>();
    file->name = std::make_shared<const std::string>(name);
    file->path = path;
    file->line_starts.push_back(0);
    for (std::size_t i = 0; i < text->size(); ++i)
        if ((*text)[i] == '\n')
            file->line_starts.push_back(i + 1);
    const pugi::xml_parse_result result = file->xml.load_buffer(text->data(), text->size());
    if (!result)
        throw Error(ExitCode::scene,
                    file->locate(result.offset).text() + ": not well-formed XML: " + result.description());
    const pugi::xml_node root = file->xml.document_element();
    if (!root)
        throw Error(ExitCode::scene, name + ": no XML element in this file");
    if (root.next_sibling() && root.next_sibling().type() == pugi::node_element)
        throw Error(ExitCode::scene, file->locate(root.next_sibling()).text() + ": a second root element <" +
                                         root.next_sibling().name() + ">; a scene file has one");
    const Location location = file->locate(root);
    if (version == 0 && std::string(root.name()) != "scene")
        throw Error(ExitCode::scene,
                    location.text() + ": the root element is <" + root.name() + ">; a scene file begins with <scene>");
    file->version = version == 0 ? 3 : version;
    if (const pugi::xml_attribute attribute = root.attribute("version")) {
        const std::string value = attribute.value();
        const std::optional<double> number = parse_number(value.substr(0, value.find('.')));
        if (!number || *number < 0 || *number > 1000)
            throw Error(ExitCode::scene, location.text() + ": version=\"" + value + "\" is no version number");
        file->version = int(*number);
    } else if (version == 0)
        diagnostics_.warn(location, "<scene> has no version; read as version 3");
    return file;
}

void Reader::collect_parameters(const File &file, const pugi::xml_node &parent, int depth) {
    for (pugi::xml_node node : parent.children()) {
        const std::string tag = node.name();
        if (tag == "default") {
            const std::string name(trimmed(node.attribute("name").value()));
            if (name.empty() || !node.attribute("value"))
                throw Error(ExitCode::scene, file.locate(node).text() + ": <default> needs name and value");
            parameters_.emplace(name, node.attribute("value").value());
            used_.insert(name);
        } else if (tag == "include") {
            if (!open_include(file, node, depth, false))
                deferred_.push_back({&file, node, depth});
        } else if (tag == "path")
            if (const std::string value = node.attribute("value").value(); value.find('$') == std::string::npos)
                folders_.push_back(file.path.parent_path() / value);
    }
}

/// False where the file name holds a parameter that is not known yet.
bool Reader::open_include(const File &file, const pugi::xml_node &node, int depth, bool last_chance) {
    const Location location = file.locate(node);
    if (!node.attribute("filename"))
        throw Error(ExitCode::scene, location.text() + ": <include> needs filename");
    if (depth >= deepest_include)
        throw Error(ExitCode::scene,
                    location.text() + ": more than " + std::to_string(deepest_include) + " includes deep; a circle?");
    std::string name;
    try {
        name = substitute(node.attribute("filename").value(), location);
    } catch (const Error &) {
        if (last_chance)
            throw;
        return false;
    }
    std::vector<fs::path> folders{file.path.parent_path()};
    folders.insert(folders.end(), folders_.begin(), folders_.end());
    const std::optional<FoundFile> found = find_file(name, folders);
    if (!found) { // reported with all the others before anything else is read
        diagnostics_.error(location, "cannot find the included file \"" + name + "\"");
        return true;
    }
    if (!found->exact)
        diagnostics_.warn(location, "\"" + name + "\" differs in case from the file " + found->path.string());
    auto included = open(found->path.string(), found->path, file.version);
    const File &opened = *included;
    included_[node.internal_object()] = std::move(included);
    collect_parameters(opened, opened.xml.document_element(), depth + 1);
    return true;
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

std::vector<std::string> Reader::parameter_names() const {
    std::vector<std::string> names;
    for (const auto &[name, value] : parameters_)
        names.push_back(name);
    return names;
}

std::string Reader::substitute(const std::string &text, const Location &location, int depth) {
    if (text.find('$') == std::string::npos)
        return text;
    if (depth > deepest_include)
        throw Error(ExitCode::scene, location.text() + ": \"" + text + "\": parameters name each other in a circle");
    const auto is_name = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               (c & 0x80) != 0;
    };
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '$') {
            result += text[i];
            continue;
        }
        std::size_t end = i + 1;
        while (end < text.size() && is_name(text[end]))
            ++end;
        const std::string whole = text.substr(i + 1, end - i - 1);
        // "$width_wide" may be $width with a tail: the longest name that is known.
        std::string name = whole;
        while (!name.empty() && !parameters_.count(name))
            name.pop_back();
        if (name.empty()) {
            std::string message =
                "parameter $" + whole + " has no value: give -D " + whole + "=... or a <default> for it";
            if (const auto nearest = nearest_name(whole, parameter_names()))
                message += "; did you mean $" + *nearest + "?";
            throw Error(ExitCode::scene, location.text() + ": " + message);
        }
        used_.insert(name);
        result += substitute(parameters_.at(name), location, depth + 1);
        if (result.size() > (1u << 20))
            throw Error(ExitCode::scene, location.text() + ": parameters expand to more than 1 MiB of text");
        i += name.size();
    }
    return result;
}

Element Reader::convert(const File &file, const pugi::xml_node &node, int depth) {
    const Location location = file.locate(node);
    if (depth > deepest_nesting)
        throw Error(ExitCode::scene,
                    location.text() + ": elements are nested more than " + std::to_string(deepest_nesting) + " deep");
    Element element;
    element.tag = node.name();
    element.location = location;
    element.version = file.version;
    for (const pugi::xml_attribute &attribute : node.attributes())
        element.attributes.emplace_back(attribute.name(), substitute(attribute.value(), location));
    convert_children(file, node, element, depth);
    return element;
}

void Reader::convert_children(const File &file, const pugi::xml_node &parent, Element &element, int depth) {
    for (pugi::xml_node child : parent.children()) {
        if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
            diagnostics_.unknown(file.locate(child),
                                 "stray text \"" + std::string(trimmed(child.value())).substr(0, 40) + "\" is ignored");
            continue;
        }
        if (child.type() != pugi::node_element)
            continue;
        const std::string tag = child.name();
        if (tag == "default")
            continue;
        if (tag == "path") {
            const std::string value = child.attribute("value").value();
            if (value.find('$') != std::string::npos)
                folders_.push_back(file.path.parent_path() / substitute(value, file.locate(child)));
            continue;
        }
        if (tag == "include") {
            const auto found = included_.find(child.internal_object());
            if (found == included_.end()) // only reached where an <include> is nested in an object
                throw Error(ExitCode::scene, file.locate(child).text() + ": <include> must stand directly in <scene>");
            const File &included = *found->second;
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

void Reader::check_given_parameters() const {
    std::string message;
    for (const auto &[name, value] : given_) {
        if (used_.count(name))
            continue;
        std::vector<std::string> known(used_.begin(), used_.end());
        message += (message.empty() ? "" : "\n") + ("-D " + name + ": the scene has no parameter of that name");
        if (const auto nearest = nearest_name(name, known))
            message += "; did you mean " + *nearest + "?";
        message += known.empty() ? " (it has none)" : " (it has: " + join(known) + ")";
    }
    if (!message.empty())
        throw Error(ExitCode::scene, message);
}

} // namespace

Document read_document(const std::string &path, const std::map<std::string, std::string> &parameters,
                       Diagnostics &diagnostics) {
    return Reader(parameters, diagnostics).read(path);
}

} // namespace gradus
