// The shifts of a render, taken back: after each launch of the stage `weigh` every offset path that arrives is made a
// base path of its own, and the same kernels, `shift`, `evaluate` and `weigh`, take it to where its base path came
// from.
#pragma once

#include "kernels/lib/vector.h"
#include "methods/method.h"
#include "runtime/device/launch_observer.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/trace/tracer.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gradus::testing {

/// What was found of the shifts of one kind, reconnections or copies of the half vector.
struct InverseShifts {
    std::uint64_t shifts = 0;     ///< those that arrive, with a density that is not 0
    std::uint64_t one_way = 0;    ///< of them those whose way back fails
    std::uint64_t other_kind = 0; ///< or is a shift of the other kind
    std::uint64_t elsewhere = 0;  ///< or ends at another vertex: by more than 1e-3 of the way there
    /// Of the others, |J_ij J_ji - 1|, the larger factor taken as the one above 1.
    std::vector<float> jacobian_errors;
};

/// Watches the launches of a device while it exists.
class ShiftInverter {
  public:
    ShiftInverter(Device &device, const Scene &scene);
    ~ShiftInverter();
    ShiftInverter(const ShiftInverter &) = delete;
    ShiftInverter &operator=(const ShiftInverter &) = delete;

    const InverseShifts &reconnections() const { return found_[0]; }
    const InverseShifts &copies() const { return found_[1]; }

  private:
    struct Base;
    using Arguments = std::map<std::string, Launch::Argument>;
    /// A launch, kept.
    struct Kept {
        KernelRequest request;
        TraitValues traits;
        Arguments arguments;
    };
    static int record_column(const Kept &weigh);
    void on_launch(const Launch &launch);
    /// The shifts of a launch of `weigh` that arrive, once it has run.
    std::vector<Base> arrivals(const Kept &weigh) const;
    void take_back(const Kept &weigh, const std::vector<Base> &bases);
    lib_float::vec3 hit(std::uint32_t primitive, lib_float::vec3 origin, lib_float::vec3 direction) const;
    /// The kernel of a stage, with all arguments as the render had them last.
    Kernel kernel_of(const std::string &stage);

    Device &device_;
    SceneTables tables_;
    Tracer tracer_;
    std::map<std::string, Kept> stages_; ///< the last launch of each kernel, by its name in the profile
    Arguments shift_;                    ///< of the last launch of `shift`, whichever kernel
    std::map<std::string, Kernel> kernels_;
    std::vector<Kept> weighed_; ///< launches of `weigh` whose results nobody has looked at
    InverseShifts found_[2];
};

} // namespace gradus::testing
