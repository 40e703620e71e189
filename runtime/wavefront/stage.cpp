#include "runtime/wavefront/stage.h"

#include "runtime/phases.h"
#include "runtime/seconds_since.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <stdexcept>

namespace gradus {

std::map<std::string, std::string> definitions_of_kind(const std::string &kind, bool is_dirac) {
    std::map<std::string, std::string> definitions;
    // Emplaced, not assigned: GCC 12 warns of the assignment of a short text (its bug 105651).
    definitions.emplace("BSDF_IS_DIRAC", is_dirac ? "1" : "0");
    if (!kind.empty())
        definitions.emplace("BSDF", kind);
    if (bsdf_kind_is_mixed(kind))
        definitions.emplace("BSDF_IS_MIXED", "1");
    return definitions;
}

namespace {

constexpr std::size_t no_kernel = ~std::size_t(0);

KernelRequest request_of(const StageDeclaration &declaration) {
    const std::string file = declaration.file.empty() ? declaration.name : declaration.file;
    KernelRequest request;
    request.name = declaration.name;
    request.file = fmt::format("kernels/stages/{}.cl", file);
    request.entry = declaration.entry.empty() ? file : declaration.entry;
    request.definitions = declaration.definitions;
    request.strict = declaration.strict;
    return request;
}

KernelRequest request_of(const StageDeclaration &declaration, std::size_t variant) {
    KernelRequest request = request_of(declaration);
    for (const auto &[name, value] : declaration.variants[variant])
        request.definitions[name] = value;
    if (declaration.variants.size() > 1)
        request.name = fmt::format("{} {}", declaration.name, variant + 1);
    return request;
}

/// For BSDF kind `kind`, and where that is a Dirac one, for all Dirac kinds of the scene.
KernelRequest request_of(const StageDeclaration &declaration, std::string kind, const std::vector<std::string> &kinds) {
    KernelRequest request = request_of(declaration);
    const bool is_dirac = bsdf_kind_is_dirac(kind);
    std::uint32_t dirac_kinds = 0; // a bit each
    for (const std::string &other : kinds)
        if (bsdf_kind_is_dirac(other))
            dirac_kinds |= 1u << std::uint32_t(bsdf_kind_named(other));
    const bool are_alike = is_dirac && declaration.dirac == DiracKinds::alike;
    const bool chooses = is_dirac && !are_alike && !std::has_single_bit(dirac_kinds);
    if (chooses) {
        kind = "specular";
        request.definitions["SPECULAR_KINDS"] = fmt::format("{}u", dirac_kinds);
    }
    for (const auto &[name, value] : definitions_of_kind(are_alike ? "" : kind, is_dirac))
        request.definitions[name] = value;
    request.name = fmt::format("{} {}", declaration.name, are_alike || chooses ? "dirac" : kind);
    return request;
}

/// For the materials of a class alone, but for what they are blended or mapped by.
void serve_class(KernelRequest &request, const StageDeclaration &declaration, const MaterialClass &one,
                 std::uint32_t number) {
    for (const auto &[name, value] : definitions_of(one))
        if (one.textured != 0 || name == "TRAIT_TRIANGLES" || name == "TRAIT_SPHERES" || name == "TRAIT_TWO_FACED")
            request.definitions[name] = value;
    request.definitions.emplace("READS_NO_SURFACE", "1");
    request.definitions.emplace("TRAIT_TEXTURED_NORMALS", "0");
    if (one.textured != 0)
        request.file = fmt::format("kernels/stages/{}.cl", declaration.textured_file);
    request.name += fmt::format(" {}", number + 1);
}

/// Sets what is the same for all launches, and lists the arguments that are tables which change. `of_class`: whose
/// textures the kernel reads itself, or class_of_blends_and_maps.
std::vector<std::string> bind_arguments(Kernel &kernel, const StageDeclaration &declaration, const Session &session,
                                        const Tables &tables, std::uint32_t of_class) {
    std::vector<std::string> provided = declaration.numbers, changing;
    provided.push_back("count");
    for (const std::string &number : provided)
        kernel.set(number, 0);
    if (of_class != class_of_blends_and_maps) {
        kernel.set("parameter_texture", session.material_classes.classes[of_class].parameter.first);
        provided.push_back("parameter_texture");
    }
    const std::vector<std::string> arguments = kernel.argument_names();
    const auto asks_for = [&](const std::string &name) {
        return std::find(arguments.begin(), arguments.end(), name) != arguments.end();
    };
    tables.for_each([&](const std::string &name, const Buffer &buffer, bool changes) {
        if (!asks_for(name))
            return;
        kernel.bind(name, buffer);
        provided.push_back(name);
        if (changes)
            changing.push_back(name);
    });
    for (const auto &[argument, table] : declaration.tables) {
        kernel.bind(argument, tables[table]);
        provided.push_back(argument);
    }
    for (const Buffer &buffer : session.scene_buffers) {
        kernel.bind(buffer);
        provided.push_back(buffer.name());
    }
    for (const auto &[name, value] : session.numbers) {
        kernel.set(name, value);
        provided.push_back(name);
    }
    for (const auto &[name, value] : session.reals) {
        kernel.set_real(name, value);
        provided.push_back(name);
    }
    for (const std::string &argument : arguments)
        if (std::find(provided.begin(), provided.end(), argument) == provided.end())
            throw std::logic_error(fmt::format("stage {}: nobody provides the argument {}", kernel.name(), argument));
    return changing;
}

} // namespace

bool Stage::is_first_of_kernel(std::size_t kind) const {
    const auto of_kind = kernel_of_.begin() + std::ptrdiff_t(kind);
    return std::find(kernel_of_.begin(), of_kind, *of_kind) == of_kind;
}

void Stage::bind(const std::string &argument, const Buffer &buffer) {
    for (Kernel &kernel : kernels_)
        kernel.bind(argument, buffer);
}

void Stage::launch(std::size_t kind, std::uint32_t count, std::uint32_t planes, LaunchNumbers numbers) {
    if (count == 0 || kernels_.empty())
        return;
    const std::size_t number = kernel_of_[kind];
    if (number == no_kernel || !kernels_[number].valid())
        return;
    Kernel &kernel = kernels_[number];
    if (bound_[number] != tables_->version()) {
        tables_->for_each([&](const std::string &name, const Buffer &buffer, bool) {
            if (std::find(changing_[number].begin(), changing_[number].end(), name) != changing_[number].end())
                kernel.bind(name, buffer);
        });
        bound_[number] = tables_->version();
    }
    kernel.set("count", count);
    for (const auto &[name, value] : numbers)
        kernel.set(name, value);
    kernel.launch_planes(count, planes);
}

Stage &Stages::add(StageDeclaration declaration) {
    stages_.emplace_back().declaration_ = std::move(declaration);
    return stages_.back();
}

void Stages::build(Session &session, const Tables &tables) {
    const std::vector<std::string> &kinds = session.scene.kinds;
    const Phase phase(session.options.phases, phase_names::compile);
    std::vector<KernelRequest> requests;
    struct Place {
        Stage *stage; // requests of a stage are in the order of its kernels
        std::uint32_t of_class = class_of_blends_and_maps;
    };
    std::vector<Place> places; // by request
    for (Stage &stage : stages_) {
        const StageDeclaration &declaration = stage.declaration_;
        if (!declaration.is_wanted)
            continue;
        stage.tables_ = &tables;
        std::size_t count = 0;
        std::map<std::uint32_t, std::size_t> for_dirac; // by class
        for (std::size_t variant = 0; variant < declaration.variants.size(); ++variant) {
            requests.push_back(request_of(declaration, variant));
            places.push_back({&stage});
            stage.kernel_of_.push_back(count++);
        }
        const std::size_t others = declaration.by_kind ? kinds.size() : declaration.variants.empty() ? 1 : 0;
        for (std::size_t k = 0; k < others; ++k) {
            const bool is_dirac = declaration.by_kind && bsdf_kind_is_dirac(kinds[k]);
            const std::vector<std::string> &only = declaration.only_kinds;
            const bool is_left_out = (is_dirac && declaration.dirac == DiracKinds::left_out) ||
                                     (!only.empty() && std::find(only.begin(), only.end(), kinds[k]) == only.end());
            const bool by_class = declaration.by_kind && !session.scene.kind_classes.empty();
            const std::uint32_t of_class = by_class ? session.scene.kind_classes[k] : class_of_blends_and_maps;
            if (is_left_out || (is_dirac && for_dirac.contains(of_class))) {
                stage.kernel_of_.push_back(is_left_out ? no_kernel : for_dirac[of_class]);
                continue;
            }
            if (is_dirac)
                for_dirac[of_class] = count;
            requests.push_back(declaration.by_kind ? request_of(declaration, kinds[k], session.scene.kinds)
                                                   : request_of(declaration));
            if (of_class != class_of_blends_and_maps)
                serve_class(requests.back(), declaration, session.material_classes.classes[of_class], of_class);
            places.push_back({&stage, of_class});
            stage.kernel_of_.push_back(count++);
        }
    }
    KernelLibrary library(session.device, session.traits, session.options.precision, session.options.work_group_size);
    const std::vector<Kernel> built = library.build(
        requests,
        [&](const std::string &name, std::size_t ready, std::size_t total, double seconds) {
            if (seconds > 0)
                session.compile_seconds[name] += seconds;
            if (seconds > 0 && session.options.on_compiled)
                session.options.on_compiled(name, ready, total, seconds);
        },
        session.options.dump_kernels);
    for (std::size_t i = 0; i < built.size(); ++i) {
        Stage &stage = *places[i].stage;
        Kernel &kernel = stage.kernels_.emplace_back(built[i]);
        stage.bound_.push_back(tables.version());
        stage.changing_.push_back(kernel.valid()
                                      ? bind_arguments(kernel, stage.declaration_, session, tables, places[i].of_class)
                                      : std::vector<std::string>());
    }
    warm(session);
}

/// A launch on no rows takes less than a thousandth of that, and no compiler is so fast.
constexpr double least_compile_seconds = 0.02;

/// Some implementations compile at the first launch: do that now, on no rows, and say what it took.
void Stages::warm(Session &session) {
    std::vector<Kernel *> kernels;
    for (Stage &stage : stages_)
        for (Kernel &kernel : stage.kernels_)
            if (kernel.valid())
                kernels.push_back(&kernel);
    for (std::size_t i = 0; i < kernels.size(); ++i) {
        const auto start = std::chrono::steady_clock::now();
        kernels[i]->set("count", 0);
        kernels[i]->launch(1);
        finish(session.device);
        kernels[i]->reset_usage();
        const double seconds = seconds_since(start);
        if (seconds < least_compile_seconds)
            continue; // it was there
        session.compile_seconds[kernels[i]->name()] += seconds;
        if (session.options.on_compiled)
            session.options.on_compiled(kernels[i]->name(), i + 1, kernels.size(), seconds);
    }
}

void Stages::set(const std::string &number, std::uint32_t value) {
    for (Stage &stage : stages_)
        for (Kernel &kernel : stage.kernels_)
            if (kernel.valid())
                kernel.set(number, value);
}

void Stages::set_real(const std::string &name, double value) {
    for (Stage &stage : stages_)
        for (Kernel &kernel : stage.kernels_)
            if (kernel.valid())
                kernel.set_real(name, value);
}

std::vector<StageTime> Stages::times() const {
    std::vector<StageTime> times;
    for (const Stage &stage : stages_)
        for (const Kernel &kernel : stage.kernels_) {
            if (!kernel.valid())
                continue;
            const Kernel::Usage usage = kernel.usage();
            if (usage.items > 0)
                times.push_back({kernel.name(), usage.seconds, usage.items, usage.launches});
        }
    return times;
}

void Stages::reset_times() {
    for (Stage &stage : stages_)
        for (Kernel &kernel : stage.kernels_)
            if (kernel.valid())
                kernel.reset_usage();
}

} // namespace gradus
