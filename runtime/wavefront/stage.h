// A step of a method: one kernel, or one for each BSDF kind of the scene, declared in one place.
#pragma once

#include "runtime/device/program.h"
#include "runtime/wavefront/session.h"
#include "runtime/wavefront/table.h"

#include <cstdint>
#include <deque>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace gradus {

/// What serves the Dirac kinds of a scene that has several, in a stage with a kernel for each BSDF kind.
enum class DiracKinds {
    chosen,  ///< one kernel that chooses among them, compiled with `specular` as its BSDF
    alike,   ///< one that does the same for all, compiled without a BSDF; it serves a single Dirac kind too
    left_out ///< none: nothing is launched on them
};

/// What a kernel of BSDF kind `kind` is compiled with; empty: of none that it calls.
std::map<std::string, std::string> definitions_of_kind(const std::string &kind, bool is_dirac);

/// Which kernels a stage has.
struct StageDeclaration {
    std::string name = {};  ///< its row in the profile; kernels by kind add theirs
    std::string file = {};  ///< kernels/stages/<file>.cl; empty: as the name
    std::string entry = {}; ///< the kernel in that file; empty: as the file
    std::map<std::string, std::string> definitions = {};
    /// True: a kernel for each BSDF kind of the scene, compiled with BSDF and BSDF_IS_DIRAC.
    bool by_kind = false;
    /// With by_kind, where kinds are kept apart by class (KINDS_BY_CLASS): the file of kernels that read the textures
    /// of their class themselves.
    std::string textured_file = {};
    DiracKinds dirac = DiracKinds::chosen; ///< with by_kind
    /// With by_kind: the kinds that anything is launched on, if not all.
    std::vector<std::string> only_kinds = {};
    /// Where there are any, a kernel for each, compiled with these definitions too.
    std::vector<std::map<std::string, std::string>> variants = {};
    bool is_wanted = true; ///< false: nothing is built, and launches do nothing
    bool strict = false;   ///< never relaxed: what counts on rounding or on NaN
    /// The arguments that each launch passes, `count` apart.
    std::vector<std::string> numbers = {};
    /// Arguments that are bound to tables of other names: argument, table at first.
    std::vector<std::pair<std::string, std::string>> tables = {};
};

/// Numbers that a launch passes, by the names of the kernel's arguments.
using LaunchNumbers = std::initializer_list<std::pair<const char *, std::uint32_t>>;

class Stage {
  public:
    /// False where the scene or the method does without it.
    bool is_wanted() const { return !kernels_.empty(); }
    /// Does without it, as if it had been declared so: before Stages::build().
    void leave_out() { declaration_.is_wanted = false; }
    /// Launches the kernel on `count` work-items; on none, nothing happens.
    void run(std::uint32_t count, LaunchNumbers numbers = {}) { launch(0, count, 1, numbers); }
    /// Whether the kernel of BSDF kind `kind` serves no kind before it.
    bool is_first_of_kernel(std::size_t kind) const;
    /// The kernel of BSDF kind `kind`, a place in SceneTables::kinds, or of that variant.
    void run_kind(std::size_t kind, std::uint32_t count, LaunchNumbers numbers = {}) {
        launch(kind, count, 1, numbers);
    }
    /// The same for each of `planes`: the kernel's get_global_id(2) says which.
    void run_planes(std::size_t kind, std::uint32_t count, std::uint32_t planes, LaunchNumbers numbers = {}) {
        launch(kind, count, planes, numbers);
    }
    /// Gives an argument another table than the one of its name, until it is bound again.
    void bind(const std::string &argument, const Buffer &buffer);

  private:
    friend class Stages;
    void launch(std::size_t kind, std::uint32_t count, std::uint32_t planes, LaunchNumbers numbers);

    StageDeclaration declaration_;
    const Tables *tables_ = nullptr;
    std::vector<Kernel> kernels_;
    std::vector<std::size_t> kernel_of_; ///< by kind or variant; else one
    std::vector<std::uint64_t> bound_;   ///< by kernel: Tables::version() when tables that change were bound last
    std::vector<std::vector<std::string>> changing_; ///< by kernel: its arguments that are such tables
};

/// All stages of a method: what builds them, warms them up and reads their times.
class Stages {
  public:
    Stage &add(StageDeclaration declaration);

    /// Compiles what is wanted and sets all arguments but those that launches pass. Throws Error where a kernel does
    /// not compile, std::logic_error where nobody provides an argument.
    void build(Session &session, const Tables &tables);

    /// Gives all kernels that ask for it another value of a number of the session.
    void set(const std::string &number, std::uint32_t value);
    /// The same for a real.
    void set_real(const std::string &name, double value);

    /// What the kernels took so far, stage by stage in the order of their declaration.
    std::vector<StageTime> times() const;
    void reset_times();

  private:
    void warm(Session &session);
    std::deque<Stage> stages_;
};

} // namespace gradus
