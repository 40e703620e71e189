#include "driver/gradient_layers.h"

#include "driver/place_in_frame.h"
#include "runtime/error.h"
#include "runtime/io/image_io.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

namespace gradus {
namespace {

struct Names {
    const char *name, *option; ///< as Gradus writes the layer; the option that names a file of its own, if there is one
    /// What other renderers call it, too; small letters and no separators (simplified()).
    std::vector<std::string> usual;
};

const std::map<GradientLayer, Names> all_names = {
    {GradientLayer::primal, {"primal", "--primal", {"primal", "throughput"}}},
    {GradientLayer::dx, {"dx", "--dx", {"dx", "gradientx", "gradx"}}},
    {GradientLayer::dy, {"dy", "--dy", {"dy", "gradienty", "grady"}}},
    {GradientLayer::direct, {"direct", "--direct", {"direct", "verydirect"}}},
    {GradientLayer::primal_variance,
     {"primal_variance", "--variance-primal", {"primalvariance", "varianceprimal", "throughputvariance"}}},
    {GradientLayer::dx_variance, {"dx_variance", "--variance-dx", {"dxvariance", "variancedx", "gradientxvariance"}}},
    {GradientLayer::dy_variance, {"dy_variance", "--variance-dy", {"dyvariance", "variancedy", "gradientyvariance"}}},
    {GradientLayer::primal_even, {"primal_even", nullptr, {"primaleven"}}},
    {GradientLayer::dx_even, {"dx_even", nullptr, {"dxeven"}}},
    {GradientLayer::dy_even, {"dy_even", nullptr, {"dyeven"}}},
    {GradientLayer::primal_even_variance, {"primal_even_variance", nullptr, {"primalevenvariance"}}},
    {GradientLayer::dx_even_variance, {"dx_even_variance", nullptr, {"dxevenvariance"}}},
    {GradientLayer::dy_even_variance, {"dy_even_variance", nullptr, {"dyevenvariance"}}},
    {GradientLayer::primal_odd, {"primal_odd", nullptr, {"primalodd"}}},
    {GradientLayer::dx_odd, {"dx_odd", nullptr, {"dxodd"}}},
    {GradientLayer::dy_odd, {"dy_odd", nullptr, {"dyodd"}}},
    {GradientLayer::primal_odd_variance, {"primal_odd_variance", nullptr, {"primaloddvariance"}}},
    {GradientLayer::dx_odd_variance, {"dx_odd_variance", nullptr, {"dxoddvariance"}}},
    {GradientLayer::dy_odd_variance, {"dy_odd_variance", nullptr, {"dyoddvariance"}}},
    {GradientLayer::albedo, {"albedo", nullptr, {"albedo"}}},
    {GradientLayer::normal, {"normal", nullptr, {"normal", "normals"}}},
    {GradientLayer::depth, {"depth", nullptr, {"depth"}}}};

/// Small letters and digits alone, so that Gradient_X and gradientX are one.
std::string simplified(const std::string &name) {
    std::string text;
    for (const unsigned char c : name)
        if (std::isalnum(c))
            text += static_cast<char>(std::tolower(c));
    return text;
}

/// Channels by the name of their layer; those outside of any have the empty one.
using Layers = std::map<std::string, std::vector<const Channel *>>;

Layers layers_of(const Image &image) {
    Layers layers;
    for (const Channel &channel : image.channels) {
        const std::size_t dot = channel.name.rfind('.');
        layers[dot == std::string::npos ? "" : channel.name.substr(0, dot)].push_back(&channel);
    }
    return layers;
}

std::string last_part(const std::string &channel) { return channel.substr(channel.rfind('.') + 1); }

std::string letters_of(const std::vector<const Channel *> &channels) {
    std::vector<std::string> letters;
    for (const Channel *channel : channels)
        letters.push_back(last_part(channel->name));
    return fmt::format("{}", fmt::join(letters, ", "));
}

/// "dx (R, G, B); primal (R, G, B)", for messages.
std::string list_of(const Layers &layers) {
    std::vector<std::string> list;
    for (const auto &[name, channels] : layers)
        list.push_back(fmt::format("{} ({})", name.empty() ? "channels without a layer" : name, letters_of(channels)));
    return fmt::format("{}", fmt::join(list, "; "));
}

[[noreturn]] void fail_to_read(const std::string &message) { throw Error(ExitCode::image, message); }

/// Whether the channels outside of any layer are the image, in a file that was given for it. Beside layers they are
/// what was rendered, and neither its differences nor their variances.
bool is_plain_image(GradientLayer layer, const Layers &layers) {
    const bool is_rendered = layer == GradientLayer::primal || layer == GradientLayer::direct;
    return layers.count("") > 0 && (is_rendered || layers.size() == 1);
}

/// Where the image is in a file: the layer's name, or nothing. `alone`: the file was given for this image.
std::optional<std::string> find_layer(const Image &image, const Layers &layers, GradientLayer layer,
                                      const GradientSources &sources, bool alone) {
    if (const auto asked = sources.names.find(layer); asked != sources.names.end())
        return layers.count(asked->second) ? std::optional(asked->second) : std::nullopt;
    // The channels of a file's first part do not bear the part's name.
    const auto part = image.metadata.find("name");
    const std::string first_part = part == image.metadata.end() ? "" : simplified(part->second);
    for (const std::string &usual : all_names.at(layer).usual) {
        for (const auto &[name, channels] : layers)
            if (simplified(name) == usual)
                return name;
        if (first_part == usual && layers.count(""))
            return "";
    }
    return alone && is_plain_image(layer, layers) ? std::optional<std::string>("") : std::nullopt;
}

/// One image as it was found.
struct Found {
    std::string where; ///< for messages
    std::uint32_t width = 0, height = 0;
    std::vector<std::string> channels;
    std::vector<float> values; ///< one plane after the other
    PlaceInFrame place;
};

/// The channels that stand for an image, in their order. Throws where they are not there.
std::vector<std::string> channels_to_take(GradientLayer layer, const std::map<std::string, const Channel *> &there,
                                          const std::string &where, const std::string &listed) {
    if (!is_feature(layer) && there.count("Y") && there.size() == 1)
        return {"Y"};
    std::vector<std::string> wanted{"R", "G", "B"};
    const char *text = is_feature(layer) ? "R, G and B" : "R, G and B, or Y alone";
    if (layer == GradientLayer::normal) {
        wanted = {"X", "Y", "Z"};
        text = "X, Y and Z";
    } else if (layer == GradientLayer::depth) {
        wanted = {"Z"};
        text = "Z";
    }
    for (const std::string &letter : wanted)
        if (!there.count(letter))
            fail_to_read(fmt::format("{} has the channels {}: there must be {}", where, listed, text));
    return wanted;
}

Found take_channels(GradientLayer layer, const Image &image, const std::vector<const Channel *> &channels,
                    const std::string &where) {
    std::map<std::string, const Channel *> there;
    for (const Channel *channel : channels) {
        std::string letter = last_part(channel->name);
        std::transform(letter.begin(), letter.end(), letter.begin(), [](unsigned char c) { return std::toupper(c); });
        if (letter != "A")
            there[letter] = channel;
    }
    Found found{where, image.width,          image.height, channels_to_take(layer, there, where, letters_of(channels)),
                {},    place_in_frame(image)};
    for (const std::string &letter : found.channels) {
        const std::vector<float> &values = there.at(letter)->values;
        found.values.insert(found.values.end(), values.begin(), values.end());
    }
    return found;
}

bool is_primal_of_half(GradientLayer layer) {
    return layer == GradientLayer::primal_even || layer == GradientLayer::primal_odd;
}

/// Whether images can be read without it.
bool may_be_missing(GradientLayer layer, const GradientSources &sources) {
    return layer == GradientLayer::direct || (sources.features && is_of_half(layer) && !is_primal_of_half(layer));
}

/// The render that writes layers of halves.
std::string layers_with(const GradientSources &sources) {
    return fmt::format("`gradus render --layers --reconstruction {}`", sources.features ? "guided" : "weighted");
}

/// Which images each file holds, so that every file is read once.
std::map<std::string, std::vector<GradientLayer>> files_to_read(const GradientSources &sources) {
    std::map<std::string, std::vector<GradientLayer>> files;
    for (const GradientLayer layer : gradient_layers) {
        if (!is_asked_for(layer, sources))
            continue;
        const auto own = sources.files.find(layer);
        if (own != sources.files.end())
            files[own->second].push_back(layer);
        else if (!sources.layered.empty())
            files[sources.layered].push_back(layer);
        else if (sources.halves && layer != GradientLayer::direct)
            throw Error(ExitCode::usage, fmt::format("there is no {}: give a file with layers, of {}",
                                                     layer_name(layer), layers_with(sources)));
        else if (layer != GradientLayer::direct)
            throw Error(ExitCode::usage, fmt::format("there is no {}: give {} FILE, or one file with layers",
                                                     layer_name(layer), all_names.at(layer).option));
    }
    return files;
}

/// That which sizes, channels and metadata go by.
GradientLayer main_layer(const GradientSources &sources) {
    return sources.halves ? GradientLayer::primal_even : GradientLayer::primal;
}

/// The name that the user gave a layer, if any, in quotes and with a blank behind it.
std::string named(GradientLayer layer, const GradientSources &sources) {
    const auto name = sources.names.find(layer);
    return name == sources.names.end() ? "" : fmt::format("\"{}\" ", name->second);
}

/// What to do where a file has not the layer that is asked for.
std::string remedy(GradientLayer layer, const GradientSources &sources) {
    const std::string writer = sources.halves       ? layers_with(sources)
                               : is_variance(layer) ? "`gradus render --layers --aov`"
                                                    : "`gradus render --layers`";
    return fmt::format("{} writes it. Name it with --layer {}=NAME", writer, layer_name(layer));
}

/// Adds what one file holds to `found`, and the metadata of the primal's file to `images`.
void read_file(const std::string &path, const std::vector<GradientLayer> &wanted, const GradientSources &sources,
               std::map<GradientLayer, Found> &found, GradientImages &images) {
    const Image image = read_image(path, sources.limits);
    const Layers layers = layers_of(image);
    for (const GradientLayer layer : wanted) {
        const bool alone = sources.files.count(layer) > 0;
        const auto name = find_layer(image, layers, layer, sources, alone);
        if (!name && may_be_missing(layer, sources) && !alone && !sources.names.count(layer))
            continue;
        if (!name)
            fail_to_read(fmt::format("'{}' has no layer {}for {}; it has: {}. {}", path, named(layer, sources),
                                     layer_name(layer), list_of(layers), remedy(layer, sources)));
        const std::string where = name->empty() ? fmt::format("'{}'", path) : fmt::format("{} of '{}'", *name, path);
        found[layer] = take_channels(layer, image, layers.at(*name), where);
        if (layer == main_layer(sources)) {
            images.metadata = image.metadata;
            images.origin = image.origin;
        }
    }
}

/// Everything is measured by the primal; features have channels of their own.
void check_equal(const Found &primal, GradientLayer layer, const Found &other) {
    if (other.width != primal.width || other.height != primal.height)
        fail_to_read(fmt::format("sizes differ: {} is {}x{}, {} is {}x{}", primal.where, primal.width, primal.height,
                                 other.where, other.width, other.height));
    if (!may_be_one_place(primal.place, other.place))
        fail_to_read(fmt::format("places differ: {} is {}, {} is {}", primal.where, place_text(primal.place),
                                 other.where, place_text(other.place)));
    if (other.channels != primal.channels && !is_feature(layer))
        fail_to_read(fmt::format("channels differ: {} has {}, {} has {}", primal.where,
                                 fmt::join(primal.channels, ", "), other.where, fmt::join(other.channels, ", ")));
}

/// Halves have no differences, or all of them with all variances.
void check_halves_are_whole(const GradientSources &sources, const std::map<GradientLayer, Found> &found) {
    const auto may_be = [&](GradientLayer layer) {
        return layer != GradientLayer::direct && may_be_missing(layer, sources);
    };
    const auto is_there = [&](GradientLayer layer) { return may_be(layer) && found.count(layer) > 0; };
    if (std::none_of(gradient_layers.begin(), gradient_layers.end(), is_there))
        return;
    for (const GradientLayer layer : gradient_layers)
        if (may_be(layer) && !is_there(layer))
            fail_to_read(fmt::format("there is no {} beside {}: halves have all differences and variances, or none",
                                     layer_name(layer), found.at(main_layer(sources)).where));
}

} // namespace

bool is_variance(GradientLayer layer) { return std::string_view(layer_name(layer)).ends_with("_variance"); }

bool is_of_half(GradientLayer layer) {
    return std::any_of(half_layers.begin(), half_layers.end(),
                       [&](const auto &half) { return std::find(half.begin(), half.end(), layer) != half.end(); });
}

bool is_feature(GradientLayer layer) {
    return layer == GradientLayer::albedo || layer == GradientLayer::normal || layer == GradientLayer::depth;
}

bool is_asked_for(GradientLayer layer, const GradientSources &sources) {
    if (layer == GradientLayer::direct)
        return true;
    if (is_feature(layer))
        return sources.features;
    return is_of_half(layer) == sources.halves && (!is_variance(layer) || sources.halves || sources.variances);
}

const char *layer_name(GradientLayer layer) { return all_names.at(layer).name; }

const float *GradientImages::find(GradientLayer layer) const {
    const auto at = planes.find(layer);
    return at == planes.end() ? nullptr : at->second.data();
}

GradientImages read_gradient_images(const GradientSources &sources) {
    GradientImages images;
    std::map<GradientLayer, Found> found;
    for (const auto &[path, wanted] : files_to_read(sources))
        read_file(path, wanted, sources, found, images);
    const Found &primal = found.at(main_layer(sources));
    for (const auto &[layer, other] : found)
        check_equal(primal, layer, other);
    check_halves_are_whole(sources, found);
    images.width = primal.width;
    images.height = primal.height;
    images.channels = primal.channels;
    for (auto &[layer, image] : found)
        images.planes[layer] = std::move(image.values);
    return images;
}

} // namespace gradus
