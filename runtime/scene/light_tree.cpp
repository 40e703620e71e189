#include "runtime/scene/light_tree.h"

#include "kernels/shared/light_tree.h"
#include "runtime/scene/light_table.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <span>

namespace gradus {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double steps = 65535;           // of a coordinate
constexpr std::uint32_t most_levels = 10; // a million leaves
constexpr double lights_of_leaf = 1;      // in the mean; two gave half as much variance again
constexpr double room = 2;                // a subtree may hold so many times its share
constexpr int bins = 16;                  // of centres along an axis, between which a node is split
constexpr std::size_t alone = 4096;       // fewer lights are not shared out to other cores

struct Extent {
    Double3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    void add(const Double3 &a, const Double3 &b) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], a[i]);
            high[i] = std::max(high[i], b[i]);
        }
    }
    void add(const Extent &other) { add(other.low, other.high); }
    double size(int axis) const { return std::max(high[axis] - low[axis], 0.0); }
    /// Squared radius of the sphere that holds the box.
    double squared() const { return (size(0) * size(0) + size(1) * size(1) + size(2) * size(2)) / 4; }
};

Double3 middle(const TreeLight &light) { return scale(add(light.low, light.high), 0.5); }

/// What lights have together, as far as it adds up.
struct Sum {
    std::size_t count = 0;
    double intensity = 0;
    Double3 normal{}; ///< of all by their intensity
    Extent extent;
    void add_light(const TreeLight &light) {
        ++count;
        intensity += light.intensity;
        normal = add(normal, scale(light.axis, light.intensity * (1 + std::cos(light.half_angle)) / 2));
        extent.add(light.low, light.high);
    }
    void add_sum(const Sum &other) {
        count += other.count;
        intensity += other.intensity;
        normal = add(normal, other.normal);
        extent.add(other.extent);
    }
    /// Half angle of the cone whose normals, evenly spread, would have that mean: (1 + cos) / 2 is its length.
    double spread() const {
        return std::acos(std::clamp(2 * length(normal) / std::max(intensity, 1e-300) - 1, -1.0, 1.0));
    }
    /// The heuristic's: intensity, times directions into which they shine (Conty Estevez and Kulla 2018, eq. 1), times
    /// size.
    double cost() const {
        const double t = spread(), w = std::min(t + pi / 2, pi);
        const double directions =
            2 * pi * (1 - std::cos(t)) +
            pi / 2 * (2 * w * std::sin(t) - std::cos(t - 2 * w) - 2 * t * std::sin(t) + std::cos(t));
        return intensity * directions * extent.squared();
    }
};

class Builder {
  public:
    Builder(LightTree &tree, std::vector<TreeLight> &lights, double scene_extent) : tree_(tree), lights_(lights) {
        Extent box;
        for (const TreeLight &light : lights)
            box.add(light.low, light.high);
        double size = std::max({box.size(0), box.size(1), box.size(2), 1e-6 * scene_extent});
        for (const double coordinate : {box.low[0], box.low[1], box.low[2]})
            size = std::max(size, 1e-6 * std::fabs(coordinate));
        size = size > 0 ? size : 1; // a lamp at the origin
        origin_ = box.low;
        scale_ = steps / size;
        tree.origin = {float(origin_[0]), float(origin_[1]), float(origin_[2])};
        tree.scale = float(scale_);
        while (tree.levels < most_levels && double(leaves()) * lights_of_leaf < double(lights.size()))
            ++tree.levels;
        tree.levels = std::max(tree.levels, 1u);
        capacity_ = std::size_t(std::max(std::ceil(room * double(lights.size()) / double(leaves())), 1.0));
        tree.nodes.assign(std::size_t((leaves() - 1) / 3) * light_node_words, 0);
        ends_.assign(leaves(), 0);
    }

    std::uint32_t leaves() const { return 1u << (2 * tree_.levels); }

    void build() { build_node(0, 0, 0, lights_.size()); }

    /// Lights of a leaf lie side by side; empty leaves end where they begin.
    std::vector<std::size_t> leaf_ends() const {
        std::vector<std::size_t> ends = ends_;
        for (std::size_t i = 1; i < ends.size(); ++i)
            ends[i] = std::max(ends[i], ends[i - 1]);
        return ends;
    }

  private:
    /// Most lights that a node of that level may hold.
    std::size_t capacity(std::uint32_t level) const { return capacity_ << (2 * (tree_.levels - level)); }

    void build_node(std::uint32_t level, std::uint32_t place, std::size_t begin, std::size_t end) {
        if (level == tree_.levels) {
            ends_[place] = end;
            return;
        }
        const std::size_t most = capacity(level + 1);
        std::array<std::size_t, 5> parts{begin, begin, 0, end, end};
        parts[2] = split(begin, end, 2 * most);
        const auto quarters = [&](int part, std::size_t first, std::size_t last) {
            parts[part] = last - first > 1 ? split(first, last, most) : last;
        };
        quarters(1, begin, parts[2]);
        quarters(3, parts[2], end);
        write_node(level, place, parts);
        const auto child = [&](std::uint32_t i) {
            if (parts[i + 1] > parts[i])
                build_node(level + 1, light_tree_children * place + i, parts[i], parts[i + 1]);
        };
        if (end - begin < alone) {
            for (std::uint32_t i = 0; i < light_tree_children; ++i)
                child(i);
        } else {
            tbb::parallel_invoke([&] { child(0); }, [&] { child(1); }, [&] { child(2); }, [&] { child(3); });
        }
    }

    /// Parts the lights of [begin, end) where that costs least, neither part more than `most`. The first part is never
    /// empty; the second is if there is one light.
    std::size_t split(std::size_t begin, std::size_t end, std::size_t most) {
        const std::size_t count = end - begin;
        if (count < 2)
            return end;
        const std::span<TreeLight> lights(lights_.data() + begin, count);
        Extent centers;
        for (const TreeLight &light : lights)
            centers.add(middle(light), middle(light));
        const double widest = std::max({centers.size(0), centers.size(1), centers.size(2)});
        const auto bin_of = [&](const TreeLight &light, int axis) {
            const double place = (middle(light)[axis] - centers.low[axis]) / centers.size(axis) * bins;
            return std::min(int(place), bins - 1);
        };
        std::array<std::array<Sum, bins>, 3> sums{};
        for (const TreeLight &light : lights)
            for (int axis = 0; axis < 3; ++axis)
                if (centers.size(axis) > 0)
                    sums[axis][bin_of(light, axis)].add_light(light);
        double least = std::numeric_limits<double>::infinity();
        int best_axis = -1, best_bin = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (!(centers.size(axis) > 0))
                continue;
            std::array<double, bins> after{};
            Sum sum;
            for (int i = bins - 1; i > 0; --i) {
                sum.add_sum(sums[axis][i]);
                after[i] = sum.cost();
            }
            sum = {};
            for (int i = 0; i + 1 < bins; ++i) {
                sum.add_sum(sums[axis][i]);
                if (sum.count == 0 || sum.count == count || sum.count > most || count - sum.count > most)
                    continue;
                // Thin slices of long boxes cost more than they seem to.
                const double cost = (sum.cost() + after[i + 1]) * widest / centers.size(axis);
                if (cost < least) {
                    least = cost;
                    best_axis = axis;
                    best_bin = i;
                }
            }
        }
        if (best_axis >= 0) {
            const auto second = std::partition(lights.begin(), lights.end(), [&](const TreeLight &light) {
                return bin_of(light, best_axis) <= best_bin;
            });
            return begin + std::size_t(second - lights.begin());
        }
        // In halves, along the longest side.
        int axis = 0;
        for (int i = 1; i < 3; ++i)
            axis = centers.size(i) > centers.size(axis) ? i : axis;
        std::nth_element(lights.begin(), lights.begin() + count / 2, lights.end(),
                         [&](const TreeLight &a, const TreeLight &b) {
                             const double x = middle(a)[axis], y = middle(b)[axis];
                             return x != y ? x < y : a.light < b.light;
                         });
        return begin + count / 2;
    }

    void write_node(std::uint32_t level, std::uint32_t place, const std::array<std::size_t, 5> &parts) {
        const std::size_t number = ((std::size_t(1) << (2 * level)) - 1) / 3 + place;
        std::uint32_t *node = &tree_.nodes[number * light_node_words];
        std::array<Sum, light_tree_children> sums;
        double brightest = 0;
        for (std::size_t i = 0; i < sums.size(); ++i) {
            for (std::size_t k = parts[i]; k < parts[i + 1]; ++k)
                sums[i].add_light(lights_[k]);
            brightest = std::max(brightest, sums[i].intensity);
        }
        for (std::size_t i = 0; i < sums.size(); ++i)
            if (sums[i].count > 0)
                write_child(node + i * light_child_words, sums[i], brightest, parts[i], parts[i + 1]);
    }

    void write_child(std::uint32_t *words, const Sum &sum, double brightest, std::size_t begin, std::size_t end) const {
        std::array<std::uint32_t, 3> center;
        for (int i = 0; i < 3; ++i) {
            const double place = (0.5 * (sum.extent.low[i] + sum.extent.high[i]) - origin_[i]) * scale_;
            center[i] = std::uint32_t(std::clamp(place + 0.5, 0.0, steps));
        }
        const double radius = std::sqrt(sum.extent.squared()) * scale_;
        words[0] = center[0] | center[1] << 16;
        words[1] = center[2] | std::uint32_t(std::clamp(std::ceil(radius), 0.0, steps)) << 16;
        // The cone about the mean normal that holds all normals.
        const double size = length(sum.normal);
        double half_angle = size > 1e-6 * sum.intensity ? 0 : pi;
        const Double3 axis = half_angle == 0 ? scale(sum.normal, 1 / size) : Double3{};
        for (std::size_t k = begin; k < end && half_angle < pi / 2; ++k) {
            const TreeLight &light = lights_[k];
            half_angle =
                std::max(half_angle, std::acos(std::clamp(dot(axis, light.axis), -1.0, 1.0)) + light.half_angle);
        }
        const double cosine = half_angle < pi / 2 ? std::cos(half_angle) : 0;
        std::uint32_t cone = 0;
        for (int i = 0; i < 3; ++i)
            cone |= (std::uint32_t(std::lround(axis[i] * cosine * 127)) & 0xFFu) << (8 * i);
        words[2] = cone | std::uint32_t(std::ceil(255 * std::sqrt(1 - cosine * cosine))) << 24;
        const float intensity = float(std::max(sum.intensity / brightest, 1e-12));
        std::memcpy(&words[3], &intensity, sizeof intensity);
    }

    LightTree &tree_;
    std::vector<TreeLight> &lights_;
    Double3 origin_{};
    double scale_ = 1;
    std::size_t capacity_ = 1;
    std::vector<std::size_t> ends_; ///< by leaf: where its lights end; 0 where it has none
};

/// Adds a leaf: its lights, and how often each is chosen there.
void add_leaf(LightTree &tree, std::uint32_t leaf, std::span<const std::uint32_t> lights,
              const std::vector<double> &weights) {
    if (!lights.empty()) {
        const AliasTable alias = make_alias_table(weights);
        for (std::size_t i = 0; i < lights.size(); ++i) {
            tree.slots.insert(tree.slots.end(), {lights[i], lights[alias.alias[i]],
                                                 std::uint32_t(std::lround(double(alias.threshold[i]) * 0x1p24))});
            tree.leaf[lights[i]] = leaf;
            tree.probability[lights[i]] = alias.probability[i];
        }
    }
    tree.leaves.push_back(std::uint32_t(tree.slots.size() / light_slot_words));
}

} // namespace

LightTree make_light_tree(std::vector<TreeLight> lights, const std::vector<std::uint32_t> &far,
                          const std::vector<double> &far_weights, std::uint32_t light_count, double scene_extent) {
    LightTree tree;
    tree.leaf.assign(light_count + 1, 0); // the last is the black light's
    tree.probability.assign(light_count, 0);
    Builder builder(tree, lights, scene_extent);
    builder.build();
    tree.slots.reserve((lights.size() + far.size()) * light_slot_words);
    tree.leaves.push_back(0);
    std::size_t begin = 0;
    std::vector<std::uint32_t> numbers;
    std::vector<double> weights;
    std::uint32_t leaf = 0;
    for (const std::size_t end : builder.leaf_ends()) {
        numbers.clear();
        weights.clear();
        for (; begin < end; ++begin) {
            numbers.push_back(lights[begin].light);
            weights.push_back(lights[begin].intensity);
        }
        add_leaf(tree, leaf++, numbers, weights);
    }
    add_leaf(tree, leaf, far, far_weights);
    return tree;
}

} // namespace gradus
