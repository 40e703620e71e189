#include "runtime/trace/opacity.h"

#include "kernels/lib/random.h"

#include <bit>

namespace gradus {

using namespace lib_float;

bool is_passable(const Scene &scene, const Shape &shape) {
    return shape.emitter < 0 && scene.materials[shape.material].opacity < 1;
}

void Opacity::add(const Scene &scene, const Shape &shape, std::uint32_t primitive) {
    primitives_.push_back({primitive, scene.materials[shape.material].opacity});
}

bool Opacity::is_met(std::size_t i, const Vector3 &origin, const Vector3 &direction) const {
    const Primitive &primitive = primitives_[i];
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    const random_bits first = random_hash(bits(origin.x), bits(origin.y), bits(origin.z), primitive.number);
    const random_bits both =
        random_hash(first.x ^ bits(direction.x), first.y ^ bits(direction.y), first.z ^ bits(direction.z), first.w);
    return random_unit(both.x) < primitive.opacity;
}

} // namespace gradus
